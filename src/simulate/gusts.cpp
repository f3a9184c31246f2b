// Curl noise: the curl of three channels of value noise.
#include <cmath>

#include "coif/simulate/air.h"

namespace coif {

namespace {

/// Root mean square of the curl for lattice values uniform in [-1, 1] and cells of size 1: the variance of
/// one derivative is (1/3) · 2 ∫f'² · (∫f² + (1−f)²)² with f the quintic, and the curl sums six of them.
constexpr double kCurlRms = 1.87303;

struct Blend {
  double f, slope;
};
Blend quintic(double t) {
  return {t * t * t * (t * (6 * t - 15) + 10), 30 * t * t * (1 - t) * (1 - t)};
}

/// Rows: gradient of channel c.
Mat3 noiseGradients(const CounterRandom& random, const Vec3& at) {
  long cell[3];
  Blend blend[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double base = std::floor(at[axis]);
    cell[axis] = long(std::fmod(base, 4294967296.0));
    blend[axis] = quintic(at[axis] - base);
  }
  Mat3 gradients = Mat3::Zero();
  for (int corner = 0; corner < 8; ++corner) {
    double w[3], s[3];
    std::uint64_t key = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const bool upper = (corner >> axis) & 1;
      w[axis] = upper ? blend[axis].f : 1 - blend[axis].f;
      s[axis] = upper ? blend[axis].slope : -blend[axis].slope;
      key = hashCombine(key, std::uint64_t(std::uint32_t(cell[axis] + upper)));
    }
    const Vec3 slope(s[0] * w[1] * w[2], w[0] * s[1] * w[2], w[0] * w[1] * s[2]);
    for (int channel = 0; channel < 3; ++channel) {
      const double value = 2 * random.uniform(hashCombine(key, std::uint64_t(channel))) - 1;
      gradients.row(channel) += value * slope.transpose();
    }
  }
  return gradients;
}

}  // namespace

Vec3 GustyWind::velocityAt(const Vec3& position, double time) const {
  if (options_.speed == 0) return options_.mean;
  const Vec3 at = (position - time * options_.mean) / options_.size;
  const double turns = time / options_.turnover;
  if (!at.allFinite() || !std::isfinite(turns)) return options_.mean;
  const double slice = std::floor(turns);
  const double angle = (turns - slice) * 1.5707963267948966;
  const CounterRandom random(options_.seed);
  const auto key = [](double index) { return std::uint64_t(std::int64_t(std::fmod(index, 9.0e15))); };
  // Two patterns, turned into each other on a circle: the variance stays.
  Mat3 g = std::cos(angle) * noiseGradients(random.child(key(slice)), at);
  if (angle > 0) g += std::sin(angle) * noiseGradients(random.child(key(slice + 1)), at);
  const Vec3 curl(g(2, 1) - g(1, 2), g(0, 2) - g(2, 0), g(1, 0) - g(0, 1));
  return options_.mean + options_.speed / kCurlRms * curl;
}

}  // namespace coif
