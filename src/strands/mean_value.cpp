#include "coif/strands/mean_value.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

#include "coif/base/check.h"

namespace coif {
namespace {

void checkSizes(std::size_t corners, std::size_t weights) {
  COIF_CHECK(corners >= 3 && weights == corners, "a polygon of at least three corners and a weight for each");
}

template <class T>
MeanValueCase inPlane(std::span<const Eigen::Matrix<T, 2, 1>> polygon, const Eigen::Matrix<T, 2, 1>& point,
                      std::span<T> out) {
  checkSizes(polygon.size(), out.size());
  static_assert(sizeof(Eigen::Matrix<T, 2, 1>) == 2 * sizeof(T));
  return meanValueWeights<T>(polygon[0].data(), polygon.size(), point.x(), point.y(), out.data());
}

template <class T>
MeanValueCase inSpace(std::span<const Eigen::Matrix<T, 3, 1>> polygon, const Eigen::Matrix<T, 3, 1>& point,
                      std::span<T> out) {
  using V3 = Eigen::Matrix<T, 3, 1>;
  checkSizes(polygon.size(), out.size());
  // Relative to the first corner: the normal of a small polygon far from the origin must not cancel.
  V3 normal = V3::Zero();
  T extent = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const V3 a = polygon[i] - polygon[0], b = polygon[(i + 1) % polygon.size()] - polygon[0];
    normal += a.cross(b);
    extent = std::max(extent, a.template lpNorm<Eigen::Infinity>());
  }
  if (!(normal.norm() > std::numeric_limits<T>::epsilon() * extent * extent)) {
    std::fill(out.begin(), out.end(), T(1) / T(polygon.size()));
    return MeanValueCase::Degenerate;
  }
  normal.normalize();
  const V3 u = normal.unitOrthogonal(), v = normal.cross(u);
  std::vector<T> xy(2 * polygon.size());
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const V3 s = polygon[i] - point;  // with the point as origin, nothing is lost near it
    xy[2 * i] = u.dot(s);
    xy[2 * i + 1] = v.dot(s);
  }
  return meanValueWeights<T>(xy.data(), polygon.size(), T(0), T(0), out.data());
}

}  // namespace

MeanValueCase meanValueCoordinates(std::span<const Vec2> polygon, const Vec2& point, std::span<double> out) {
  return inPlane<double>(polygon, point, out);
}
MeanValueCase meanValueCoordinates(std::span<const Vec2f> polygon, const Vec2f& point, std::span<float> out) {
  return inPlane<float>(polygon, point, out);
}
MeanValueCase meanValueCoordinates(std::span<const Vec3> polygon, const Vec3& point, std::span<double> out) {
  return inSpace<double>(polygon, point, out);
}
MeanValueCase meanValueCoordinates(std::span<const Vec3f> polygon, const Vec3f& point, std::span<float> out) {
  return inSpace<float>(polygon, point, out);
}

}  // namespace coif
