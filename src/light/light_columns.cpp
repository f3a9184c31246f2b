#include "light/light_columns.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "coif/base/lanes.h"

namespace coif::light {
namespace {

constexpr std::size_t kBlock = 16;           // columns that are looked at together
constexpr std::size_t kStrip = 64 * kBlock;  // columns whose sums stay in the nearest cache

// exp(−x), x >= 0: two to the nearest whole number, a minimax polynomial for the rest, 1 at 0 and 1.1e-7 off
// at most; below 2⁻¹²⁶ it stays there. Beside kWhole a float has no fraction, and its last bits are the whole
// number.
template <class Float, class Int>
[[gnu::always_inline]] inline void expOfMinus(const Float& x, Float& out) {
  constexpr float kWhole = 0x1.8p23f;
  const Float zero = Float{};
  Float twos = x * -1.44269504088896f;
  twos = twos > -126.0f ? twos : zero - 126.0f;
  const Float shifted = twos + kWhole, rest = twos - (shifted - kWhole);
  Float series = rest * 0.0013264727f + 0.009671513f;
  for (const float term : {0.055507336f, 0.24022242f, 0.693147f, 1.0f}) series = series * rest + term;
  Int bits;
  loadLanes(bits, &shifted);
  bits = (bits + 127) << 23;  // of kWhole nothing is left
  Float scale;
  loadLanes(scale, &bits);
  out = series * scale;
}

// Bit b: block b of a row holds hair.
std::uint64_t blocksWithHair(const float* row, std::size_t blocks) {
  std::uint64_t with = 0;
  for (std::size_t b = 0; b < blocks; ++b) {
    std::uint64_t words[kBlock / 2], any = 0;
    loadLanes(words, row + b * kBlock);
    for (const std::uint64_t word : words) any |= word;
    with |= std::uint64_t(any != 0) << b;
  }
  return with;
}

#if defined(__x86_64__)
COIF_TARGET_16_LANES std::uint64_t blocksWithHair16(const float* row, std::size_t blocks) {
  std::uint64_t with = 0;
  for (std::size_t b = 0; b < blocks; ++b) {
    const __m512i bits = _mm512_loadu_si512(row + b * kBlock);
    with |= std::uint64_t(_mm512_test_epi32_mask(bits, bits) != 0) << b;
  }
  return with;
}

// Past the caches: the grid is larger than the nearest ones, and nobody asks for it before it is done.
COIF_TARGET_16_LANES void streamOut16(const float* from, std::size_t count, float* to) {
  if (reinterpret_cast<std::uintptr_t>(to) % 64 != 0) {
    std::copy_n(from, count, to);
    return;
  }
  for (std::size_t at = 0; at < count; at += kBlock) _mm512_stream_ps(to + at, _mm512_load_ps(from + at));
}
#endif

// Along the light; a block without hair lets through what came to it.
template <int W>
[[gnu::always_inline]] inline void columns(float* depths, float* out, std::size_t width, std::size_t layers,
                                           std::size_t first) {
  using Float = typename Lanes<W>::Float;
  using Int = typename Lanes<W>::Int;
  const Float none = Float{};
  alignas(64) float sums[kStrip], passed[kStrip];
  for (std::size_t begin = 0; begin < width; begin += kStrip) {
    const std::size_t strip = std::min(kStrip, width - begin);
    std::fill_n(sums, strip, 0.0f);
    std::fill_n(passed, strip, 1.0f);
    for (std::size_t layer = 0; layer < layers; ++layer) {
      float* const row = depths + (first + layer) % layers * width + begin;
      std::uint64_t with = 0;
#if defined(__x86_64__)
      if constexpr (W == 16) with = blocksWithHair16(row, strip / kBlock);
#endif
      if constexpr (W != 16) with = blocksWithHair(row, strip / kBlock);
      for (; with != 0; with &= with - 1) {
        const std::size_t block = std::size_t(std::countr_zero(with)) * kBlock;
        for (std::size_t at = block; at < block + kBlock; at += W) {
          Float sum, more;
          loadLanes(sum, sums + at);
          loadLanes(more, row + at);
          sum += more;
          expOfMinus<Float, Int>(sum, more);
          storeLanes(sums + at, sum);
          storeLanes(passed + at, more);
          storeLanes(row + at, none);
        }
      }
      float* const to = out + (row - depths);
#if defined(__x86_64__)
      if constexpr (W == 16) streamOut16(passed, strip, to);
#endif
      if constexpr (W != 16) std::copy_n(passed, strip, to);
    }
  }
}

#if defined(__x86_64__)
COIF_TARGET_16_LANES void columns16(float* depths, float* out, std::size_t width, std::size_t layers,
                                    std::size_t first) {
  columns<16>(depths, out, width, layers, first);
  _mm_sfence();  // streamed values are there before whatever the caller writes next
}
COIF_TARGET_8_LANES void columns8(float* depths, float* out, std::size_t width, std::size_t layers,
                                  std::size_t first) {
  columns<8>(depths, out, width, layers, first);
}
#endif

}  // namespace

void transmittanceByColumns(float* depths, float* out, std::size_t width, std::size_t layers,
                            std::size_t first, int lanes) {
#if defined(__x86_64__)
  if (lanes == 16) return columns16(depths, out, width, layers, first);
  if (lanes == 8) return columns8(depths, out, width, layers, first);
#endif
  (void)lanes;
  columns<4>(depths, out, width, layers, first);
}

}  // namespace coif::light
