#include <algorithm>
#include <cmath>
#include <numbers>

#include "coif/scalp/region.h"
#include "connectivity.h"

namespace coif {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// Monotone cubic through ascending knots (Fritsch and Carlson 1980, Butland's slopes); flat at both ends.
class MonotoneCurve {
 public:
  explicit MonotoneCurve(std::vector<Vec2> knots) : knots_(std::move(knots)), slopes_(knots_.size(), 0.0) {
    for (std::size_t i = 1; i + 1 < knots_.size(); ++i) {
      const double a = secant(i - 1), b = secant(i);
      if (a * b > 0) slopes_[i] = 2 * a * b / (a + b);
    }
  }
  double operator()(double x) const {
    if (x <= knots_.front().x()) return knots_.front().y();
    for (std::size_t i = 0; i + 1 < knots_.size(); ++i) {
      if (x > knots_[i + 1].x()) continue;
      const double h = knots_[i + 1].x() - knots_[i].x(), t = (x - knots_[i].x()) / h;
      const double u = 1 - t;
      return u * u * (1 + 2 * t) * knots_[i].y() + t * t * (3 - 2 * t) * knots_[i + 1].y() +
             h * t * u * (u * slopes_[i] - t * slopes_[i + 1]);
    }
    return knots_.back().y();
  }

 private:
  double secant(std::size_t i) const {
    return (knots_[i + 1].y() - knots_[i].y()) / (knots_[i + 1].x() - knots_[i].x());
  }
  std::vector<Vec2> knots_;
  std::vector<double> slopes_;
};

/// Elevation of the mirror plane's profile at a height above the chin, on the front (+1) or the back (−1).
double profileElevation(const Surface& surface, const HeadFrame& frame, double crown, double fraction,
                        int side) {
  const double above = crown - (1 - fraction) * frame.height - frame.centre.dot(frame.up);
  const Vec3 from = frame.centre + above * frame.up;
  const Vec3 outside = from + 4.0 * side * frame.depth * frame.forward;
  SurfacePoint hit;
  if (!surface.intersect(outside, from - outside, 1.0, hit)) return std::atan2(above, 0.5 * frame.depth);
  return frame.angles(hit.position).y();
}

MonotoneCurve hairline(const HeadFrame& frame, double front, double nape, double clearance) {
  // Without ears: where those of people are.
  const double earTop = frame.earsFound ? frame.earTop : -10 * kDegree;
  const double earFront =
      std::clamp(frame.earsFound ? frame.earFront : 82 * kDegree, 70 * kDegree, 100 * kDegree);
  const double earBack =
      std::clamp(frame.earsFound ? frame.earBack : 116 * kDegree, 105 * kDegree, 135 * kDegree);
  const double ear = std::clamp(earTop + clearance, nape + 5 * kDegree, front);
  const double start = earFront - clearance, end = earBack + clearance;
  return MonotoneCurve({{0, front},
                        {30 * kDegree, front},
                        {start - 18 * kDegree, ear + 0.55 * (front - ear)},
                        {start, ear},
                        {end, ear},
                        {end + 0.35 * (std::numbers::pi - end), ear + 0.68 * (nape - ear)},
                        {end + 0.7 * (std::numbers::pi - end), ear + 0.97 * (nape - ear)},
                        {std::numbers::pi, nape}});
}

/// The highest-reaching of the shells that are not small; joined through seams.
std::vector<std::uint32_t> headShell(const PolygonMesh& mesh, const Vec3& up,
                                     std::vector<std::string>& notes) {
  std::vector<std::uint32_t> corners = mesh.corners;
  const auto lowest = coincidentRepresentatives(mesh.positions, 0);
  bool seams = false;
  for (std::uint32_t& v : corners) seams |= lowest[v] != v, v = lowest[v];
  const auto shellOf = faceShells(mesh.faceOffsets, corners, mesh.vertexCount());
  const std::size_t count = shellOf.empty() ? 0 : *std::max_element(shellOf.begin(), shellOf.end()) + 1;
  std::vector<double> area(count, 0.0), top(count, -std::numeric_limits<double>::infinity());
  std::vector<Vec3> points;
  for (std::size_t f = 0; f < mesh.faceCount(); ++f) {
    points.clear();
    for (std::uint32_t v : mesh.face(f)) points.push_back(mesh.positions[v]);
    area[shellOf[f]] += newellNormal(points).norm();
    for (const Vec3& p : points) top[shellOf[f]] = std::max(top[shellOf[f]], p.dot(up));
  }
  std::size_t best = count;
  const double greatest = count > 0 ? *std::max_element(area.begin(), area.end()) : 0;
  for (std::size_t s = 0; s < count; ++s)
    if (area[s] >= 0.1 * greatest && (best == count || top[s] > top[best])) best = s;
  std::vector<std::uint32_t> faces;
  for (std::uint32_t f = 0; f < mesh.faceCount(); ++f)
    if (shellOf[f] == best) faces.push_back(f);
  if (count > 1)
    notes.push_back("Of " + std::to_string(count) +
                    " shells the one that reaches highest was taken as the head.");
  if (seams) notes.push_back("Vertices at equal positions were treated as joined.");
  return faces;
}

}  // namespace

Result<Region> automaticCap(const Surface& surface, const CapOptions& options) {
  const PolygonMesh& mesh = surface.mesh();
  COIF_TRY(validate(mesh));
  Region region;
  const Vec3 up = options.head.up.value_or(mesh.upAxis == UpAxis::Y ? Vec3::UnitY() : Vec3::UnitZ());
  const auto shell = headShell(mesh, up, region.notes);
  if (shell.empty()) return makeError(ErrorCode::Degenerate, "The mesh has no face.");
  COIF_ASSIGN(HeadFrame frame, estimateHeadFrame(surface, shell, options.head));
  double crown = -std::numeric_limits<double>::infinity();
  for (std::uint32_t f : shell)
    for (std::uint32_t v : mesh.face(f)) crown = std::max(crown, mesh.positions[v].dot(frame.up));

  const bool person = frame.faceFound || options.head.forward.has_value();
  double front = options.upperCapElevationRad, nape = front;
  if (person) {
    front = std::clamp(profileElevation(surface, frame, crown, options.foreheadLine, 1), 15 * kDegree,
                       50 * kDegree);
    nape = std::clamp(profileElevation(surface, frame, crown, options.napeLine, -1), -50 * kDegree,
                      -15 * kDegree);
  } else {
    region.notes.push_back("Without a face the upper cap was taken.");
  }
  const MonotoneCurve line = person ? hairline(frame, front, nape, options.earClearanceRad)
                                    : MonotoneCurve({{0, front}, {std::numbers::pi, front}});
  region.field.assign(mesh.vertexCount(), -std::numbers::pi);
  region.faces.assign(mesh.faceCount(), 0);
  for (std::uint32_t f : shell) {
    double sum = 0;
    for (std::uint32_t v : mesh.face(f)) {
      const Vec2 angles = frame.angles(mesh.positions[v]);
      region.field[v] = angles.y() - line(std::abs(angles.x()));
      sum += region.field[v];
    }
    region.faces[f] = sum > 0;
  }
  region.notes.insert(region.notes.end(), frame.notes.begin(), frame.notes.end());
  region.frame = std::move(frame);
  if (region.count() == 0) return makeError(ErrorCode::Degenerate, "Nothing lies above the hairline.");
  return region;
}

}  // namespace coif
