#include "coif/strands/root_face.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "coif/base/check.h"
#include "coif/scalp/polygon_mesh.h"
#include "coif/scalp/triangulation.h"
#include "coif/strands/mean_value.h"

namespace coif {
namespace {

constexpr double kLeastArea =
    1e-12;  // of the extent squared: below it the area is rounding of the coordinates
constexpr double kLeastSide = 1e-9;  // of the extent: below it a side has no direction

double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}
double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  return cross(b - a, c - a);
}

/// The open segments cross properly.
bool segmentsCross(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  return turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0;
}

}  // namespace

RootFace::RootFace(std::span<const Vec3> corners) {
  COIF_CHECK(corners.size() >= 3, "a root face has at least three corners");
  layDown(corners);
  if (area_ <= 0) return;
  convex_ = isConvex();
  triangulated_ = !convex_ && crossesItself();
  triangulateFace(corners);
}

void RootFace::layDown(std::span<const Vec3> corners) {
  origin_ = corners[0];
  double extent = 0;
  std::vector<Vec3> local;
  for (const Vec3& corner : corners) {
    local.push_back(corner - origin_);
    extent = std::max(extent, local.back().norm());
  }
  polygon_.assign(corners.size(), Vec2::Zero());
  const Vec3 normal = newellNormal(local);
  if (!(normal.norm() > 2 * kLeastArea * extent * extent)) return;
  const Vec3 n = normal.normalized();
  Vec3 side = local[1] - local[1].dot(n) * n;
  axisU_ = side.norm() > kLeastSide * extent ? Vec3(side.normalized()) : Vec3(n.unitOrthogonal());
  axisV_ = n.cross(axisU_);
  for (std::size_t i = 0; i < corners.size(); ++i)
    polygon_[i] = Vec2(axisU_.dot(local[i]), axisV_.dot(local[i]));
  lo_ = hi_ = polygon_[0];
  for (const Vec2& p : polygon_) lo_ = lo_.cwiseMin(p), hi_ = hi_.cwiseMax(p);
  area_ = normal.norm() / 2;
}

void RootFace::triangulateFace(std::span<const Vec3> corners) {
  PolygonMesh mesh;
  mesh.positions.assign(corners.begin(), corners.end());
  std::vector<std::uint32_t> face(corners.size());
  std::iota(face.begin(), face.end(), 0u);
  mesh.addFace(face);
  triangles_ = triangulate(mesh).triangles;
  double sum = 0;
  for (const auto& t : triangles_) {
    sum += std::abs(turn(polygon_[t[0]], polygon_[t[1]], polygon_[t[2]])) / 2;
    triangleEnds_.push_back(sum);
  }
  if (triangulated_) area_ = sum;
}

bool RootFace::isConvex() const {
  const std::size_t n = polygon_.size();
  double turned = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 a = polygon_[(i + 1) % n] - polygon_[i], b = polygon_[(i + 2) % n] - polygon_[(i + 1) % n];
    if (cross(a, b) < 0) return false;
    turned += std::atan2(cross(a, b), a.dot(b));
  }
  return turned < 7;  // once round is 2π; a star that turns twice is no convex polygon
}

bool RootFace::crossesItself() const {
  const std::size_t n = polygon_.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;
      if (segmentsCross(polygon_[i], polygon_[i + 1], polygon_[j], polygon_[(j + 1) % n])) return true;
    }
  }
  return false;
}

Vec2 RootFace::project(const Vec3& point) const {
  const Vec3 s = point - origin_;
  return {axisU_.dot(s), axisV_.dot(s)};
}

bool RootFace::contains(const Vec2& point) const {
  const std::size_t n = polygon_.size();
  if (convex_) {
    for (std::size_t i = 0; i < n; ++i) {
      if (turn(polygon_[i], polygon_[i + 1 == n ? 0 : i + 1], point) < 0) return false;
    }
    return true;
  }
  bool inside = false;  // even-odd ray to +u
  for (std::size_t i = 0, j = n - 1; i < n; j = i++) {
    const Vec2 &a = polygon_[i], &b = polygon_[j];
    if ((a.y() > point.y()) != (b.y() > point.y()) &&
        point.x() < a.x() + (b.x() - a.x()) * (point.y() - a.y()) / (b.y() - a.y())) {
      inside = !inside;
    }
  }
  return inside;
}

Vec2 RootFace::fromSquare(double u, double v) const {
  const double total = triangleEnds_.back(), target = u * total;
  auto t = std::size_t(std::upper_bound(triangleEnds_.begin(), triangleEnds_.end(), target) -
                       triangleEnds_.begin());
  t = std::min(t, triangles_.size() - 1);
  const double start = t == 0 ? 0 : triangleEnds_[t - 1], area = triangleEnds_[t] - start;
  const double s = std::sqrt(area > 0 ? std::clamp((target - start) / area, 0.0, 1.0) : 0.5);
  const auto& [a, b, c] = triangles_[t];
  return (1 - s) * polygon_[a] + s * (1 - v) * polygon_[b] + s * v * polygon_[c];
}

bool RootFace::weights(const Vec2& point, std::span<double> out) const {
  if (!triangulated_) {
    meanValueCoordinates(polygon_, point, out);
    return std::any_of(out.begin(), out.end(), [](double w) { return w < 0; });
  }
  // The triangle that holds the point best: the one with the greatest least barycentric coordinate.
  std::fill(out.begin(), out.end(), 0.0);
  Vec3 best(-1, -1, -1);
  const std::array<std::uint32_t, 3>* holder = nullptr;
  for (const auto& t : triangles_) {
    const Vec2 &a = polygon_[t[0]], &b = polygon_[t[1]], &c = polygon_[t[2]];
    const double whole = turn(a, b, c);
    if (whole == 0) continue;
    const Vec3 bary(turn(b, c, point) / whole, turn(c, a, point) / whole, turn(a, b, point) / whole);
    if (holder == nullptr || bary.minCoeff() > best.minCoeff()) best = bary, holder = &t;
  }
  if (holder == nullptr) {  // cannot be with an area > 0; a corner is always right
    out[0] = 1;
    return false;
  }
  best = best.cwiseMax(0.0);
  best /= best.sum();
  for (int i = 0; i < 3; ++i) out[(*holder)[std::size_t(i)]] += best[i];
  return false;
}

}  // namespace coif
