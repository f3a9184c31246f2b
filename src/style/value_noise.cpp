#include "style/value_noise.h"

namespace coif::style {
namespace {
constexpr double kFarthest = 1e15;  // a place of the lattice still is a whole number of its own

std::int64_t cell(double x) {
  return std::int64_t(std::floor(std::clamp(x, -kFarthest, kFarthest)));
}

Vec3 unpacked(std::uint64_t bits) {
  constexpr double kScale = 2.0 / 0x1fffff;  // 21 bits a part
  return Vec3(double(bits >> 43), double((bits >> 22) & 0x1fffff), double((bits >> 1) & 0x1fffff)) * kScale -
         Vec3::Ones();
}
}  // namespace

Vec3 latticeValue(const CounterRandom& random, std::int64_t i, std::int64_t j, std::int64_t k,
                  std::int64_t layer) {
  std::uint64_t key = hashCombine(std::uint64_t(i), std::uint64_t(j));
  key = hashCombine(hashCombine(key, std::uint64_t(k)), std::uint64_t(layer));
  return unpacked(random.bits(key));
}

Vec3 valueNoise(const CounterRandom& random, const Vec3& at, std::int64_t layer) {
  const std::array<std::int64_t, 3> low{cell(at.x()), cell(at.y()), cell(at.z())};
  std::array<double, 3> t;
  for (int a = 0; a < 3; ++a) {
    const double s = std::clamp(at[a] - double(low[a]), 0.0, 1.0);
    t[a] = s * s * s * (10 + s * (6 * s - 15));
  }
  Vec3 sum = Vec3::Zero();
  for (int corner = 0; corner < 8; ++corner) {
    const int x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
    const double weight = (x ? t[0] : 1 - t[0]) * (y ? t[1] : 1 - t[1]) * (z ? t[2] : 1 - t[2]);
    sum += weight * latticeValue(random, low[0] + x, low[1] + y, low[2] + z, layer);
  }
  return sum;
}

Vec3 variation(const CounterRandom& random, const StrandPlace& place, double coherence, std::int64_t layer) {
  if (coherence > 0) return valueNoise(random, place.root / coherence, layer);
  return unpacked(random.bits(hashCombine(place.id, std::uint64_t(layer))));
}

Vec3 AlongNoise::operator()(double t) {
  const std::int64_t first = cell(t) - 1;
  if (first == first_ + 1) {
    nodes_ = {nodes_[1], nodes_[2], nodes_[3], variation(random_, place_, coherence_, first + 3)};
  } else if (first != first_) {
    for (int i = 0; i < 4; ++i) nodes_[i] = variation(random_, place_, coherence_, first + i);
  }
  first_ = first;
  return splineAt<Vec3>(nodes_, t - double(first));
}

}  // namespace coif::style
