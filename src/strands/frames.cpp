#include "coif/strands/frames.h"

#include <algorithm>
#include <cmath>

#include "coif/base/check.h"
#include "coif/scalp/polygon_mesh.h"

namespace coif {
namespace {

constexpr double kOpposite = 1e-14;  // of |a + b|² = 4: below it two tangents are opposite

/// v seen in the mirror whose normal is m (not zero).
Vec3 mirrored(const Vec3& v, const Vec3& m) {
  return v - (2 * m.dot(v) / m.squaredNorm()) * m;
}

Frame completed(const Vec3& tangent, const Vec3& nearNormal) {
  Frame frame;
  frame.tangent = tangent;
  frame.normal = (nearNormal - nearNormal.dot(tangent) * tangent).normalized();
  frame.binormal = tangent.cross(frame.normal);
  return frame;
}

/// Direction of the curve at point p; zero where neighbours coincide.
template <class Points>
Vec3 tangentAt(const Points& points, std::size_t p) {
  const std::size_t before = p > 0 ? p - 1 : 0, after = std::min(p + 1, points.size() - 1);
  const Vec3 span = points[after].template cast<double>() - points[before].template cast<double>();
  const double length = span.norm();
  return length > 0 ? Vec3(span / length) : Vec3(Vec3::Zero());
}

template <class Points>
void transport(const Points& points, const Frame& root, std::span<Frame> out) {
  COIF_CHECK(out.size() == points.size(), "a frame for every point");
  Frame frame = root;
  bool started = false;
  Vec3 at = Vec3::Zero();
  for (std::size_t p = 0; p < out.size(); ++p) {
    const Vec3 here = points[p].template cast<double>(), tangent = tangentAt(points, p);
    const Vec3 step = here - at;
    if (!tangent.isZero(0)) {
      if (!started || step.squaredNorm() == 0) {
        frame = turnedTo(frame, tangent);
      } else {  // mirror in the bisector of the two points, then in that of the two tangents
        const Vec3 normal = mirrored(frame.normal, step), mirroredTangent = mirrored(frame.tangent, step);
        const Vec3 second = tangent - mirroredTangent;
        frame = completed(tangent, second.squaredNorm() > 0 ? mirrored(normal, second) : normal);
      }
      started = true;
    }
    at = here;
    out[p] = frame;
  }
}

}  // namespace

Frame faceFrame(std::span<const Vec3> corners) {
  COIF_CHECK(corners.size() >= 3, "a face has at least three corners");
  std::vector<Vec3> local;
  for (const Vec3& corner : corners) local.push_back(corner - corners[0]);
  const Vec3 area = newellNormal(local);
  if (!(area.norm() > 0)) return {};
  const Vec3 tangent = area.normalized();
  const Vec3 side = local[1] - local[1].dot(tangent) * tangent;
  return completed(tangent,
                   side.norm() > 1e-9 * std::sqrt(area.norm()) ? side : Vec3(tangent.unitOrthogonal()));
}

Frame turnedTo(const Frame& frame, const Vec3& direction) {
  const Vec3 tangent = direction.normalized(), half = frame.tangent + tangent;
  if (half.squaredNorm() < 4 * kOpposite) return completed(tangent, -frame.normal);
  // Mirrored in the plane across the tangent, then across the bisector: together the least rotation.
  return completed(tangent, mirrored(mirrored(frame.normal, frame.tangent), half));
}

void parallelTransport(std::span<const Vec3> points, const Frame& root, std::span<Frame> out) {
  transport(points, root, out);
}
void parallelTransport(std::span<const Vec3f> points, const Frame& root, std::span<Frame> out) {
  transport(points, root, out);
}

}  // namespace coif
