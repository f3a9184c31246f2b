#include "coif/strands/hausdorff.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "coif/base/check.h"

namespace coif {
namespace {

double squaredDistance(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 edge = b - a;
  const double length2 = edge.squaredNorm();
  const double t = length2 > 0 ? std::clamp(edge.dot(p - a) / length2, 0.0, 1.0) : 0.0;
  return (p - a - t * edge).squaredNorm();
}

}  // namespace

double oneSidedHausdorff(std::span<const Vec3> from, std::span<const Vec3> to) {
  COIF_CHECK(!to.empty(), "a distance needs a curve to measure to");
  const std::size_t segments = std::max<std::size_t>(to.size(), 2) - 1;
  double worst = 0;
  std::size_t last = 0;
  for (const Vec3& p : from) {
    double best = std::numeric_limits<double>::infinity();
    // From the previous point's segment outwards; a point nearer than the worst so far cannot raise it.
    const std::size_t start = last;
    for (std::size_t k = 0; k < segments && best > worst; ++k) {
      const std::size_t s = (start + k) % segments;
      const double distance = squaredDistance(p, to[s], to[std::min(s + 1, to.size() - 1)]);
      if (distance < best) best = distance, last = s;
    }
    worst = std::max(worst, best);
  }
  return std::sqrt(worst);
}

double hausdorff(std::span<const Vec3> a, std::span<const Vec3> b) {
  return std::max(oneSidedHausdorff(a, b), oneSidedHausdorff(b, a));
}

}  // namespace coif
