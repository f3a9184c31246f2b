// Smooth random vectors: value noise over the scalp, a cubic along the strand.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "coif/base/random.h"
#include "style/styled_strand.h"

namespace coif::style {

/// Vectors with parts in [−1, 1] at the points of a lattice, by (random, i, j, k, layer).
Vec3 latticeValue(const CounterRandom& random, std::int64_t i, std::int64_t j, std::int64_t k,
                  std::int64_t layer);
/// Between lattice points, C¹.
Vec3 valueNoise(const CounterRandom& random, const Vec3& at, std::int64_t layer);

/// A random vector of a place, parts in [−1, 1]. `coherence` (cm): over how far neighbours agree; 0: each
/// for itself.
Vec3 variation(const CounterRandom& random, const StrandPlace& place, double coherence,
               std::int64_t layer = 0);
/// Of a strand: the strands of a lock have the same.
inline Vec3 variation(const CounterRandom& random, const StyledStrand& strand, double coherence) {
  return variation(random, strand.lock, strand.inLock ? 0 : coherence);
}

/// Noise along one strand: a Catmull–Rom curve through a variation at each whole number.
class AlongNoise {
 public:
  AlongNoise(const CounterRandom& random, const StrandPlace& place, double coherence)
      : random_(random), place_(place), coherence_(coherence) {}
  Vec3 operator()(double t);

 private:
  const CounterRandom random_;
  const StrandPlace& place_;
  const double coherence_;
  std::int64_t first_ = INT64_MIN;
  std::array<Vec3, 4> nodes_;  // at first_ … first_ + 3
};

}  // namespace coif::style
