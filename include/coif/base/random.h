// Counter-based random numbers: a value is a pure function of (key, counter), so order and threads do not
// matter.
#pragma once

#include <cstdint>

namespace coif {

/// Bijective 64-bit mixer (the finaliser of SplitMix64, Steele et al. 2014).
constexpr std::uint64_t mix64(std::uint64_t x) {
  x ^= x >> 30;
  x *= 0xbf58476d1ce4e5b9ULL;
  x ^= x >> 27;
  x *= 0x94d049bb133111ebULL;
  x ^= x >> 31;
  return x;
}

constexpr std::uint64_t hashCombine(std::uint64_t key, std::uint64_t value) {
  return mix64(key + 0x9e3779b97f4a7c15ULL * (value + 1));
}

/// A stream of numbers named by its key; bits(i) is the i-th.
class CounterRandom {
 public:
  constexpr explicit CounterRandom(std::uint64_t key) : key_(key) {}
  constexpr CounterRandom(std::uint64_t seed, std::uint64_t stream)
      : key_(hashCombine(mix64(seed + 1), stream)) {}

  constexpr std::uint64_t bits(std::uint64_t counter) const { return hashCombine(key_, counter); }
  /// Uniform in [0, 1), 53 bits.
  constexpr double uniform(std::uint64_t counter) const { return double(bits(counter) >> 11) * 0x1.0p-53; }
  /// Uniform in {0, …, n − 1}; n > 0. Bias below n / 2^32.
  constexpr std::uint32_t below(std::uint64_t counter, std::uint32_t n) const {
    return std::uint32_t(((bits(counter) >> 32) * n) >> 32);
  }
  /// A stream of its own for a sub-object.
  constexpr CounterRandom child(std::uint64_t id) const { return CounterRandom(hashCombine(key_, ~id)); }

 private:
  std::uint64_t key_;
};

}  // namespace coif
