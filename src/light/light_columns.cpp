#include "light/light_columns.h"

#include <algorithm>
#include <cstdint>

#include "coif/base/lanes.h"

namespace coif::light {
namespace {

constexpr std::size_t kStrip = 1024;  // columns whose sums stay in the nearest cache

// exp(−x), x >= 0: two to the whole part, a Taylor series of seventh order for the rest in (−ln 2, 0], whose
// remainder is at most (ln 2)⁸ / 8! = 1.3e-6, 2.6e-6 of e^rest at the far end; below 2⁻¹²⁶ it stays there.
template <class Float, class Int>
[[gnu::always_inline]] inline void expOfMinus(const Float& x, Float& out) {
  const Float zero = Float{};
  Float twos = x * -1.44269504088896f;
  twos = twos > -126.0f ? twos : zero - 126.0f;
  const Int whole = __builtin_convertvector(twos, Int);
  const Float rest = (twos - __builtin_convertvector(whole, Float)) * 0.693147180559945f;
  Float series = rest * (1.0f / 5040) + 1.0f / 720;
  for (const float term : {1.0f / 120, 1.0f / 24, 1.0f / 6, 0.5f, 1.0f, 1.0f}) series = series * rest + term;
  const Int bits = (whole + 127) << 23;
  Float scale;
  loadLanes(scale, &bits);
  out = series * scale;
}

// Along the light; where no hair is in any of a group's cells, what passed before goes on.
template <int W>
[[gnu::always_inline]] inline void columns(float* cells, std::size_t width, std::size_t layers,
                                           std::size_t first) {
  using Float = typename Lanes<W>::Float;
  using Int = typename Lanes<W>::Int;
  Float sum[kStrip / W], passed[kStrip / W];
  for (std::size_t begin = 0; begin < width; begin += kStrip) {
    const std::size_t groups = std::min(kStrip, width - begin) / W;
    for (std::size_t g = 0; g < groups; ++g) sum[g] = Float{}, passed[g] = Float{} + 1.0f;
    for (std::size_t layer = 0; layer < layers; ++layer) {
      float* row = cells + (first + layer) % layers * width + begin;
      for (std::size_t g = 0; g < groups; ++g) {
        std::uint64_t words[W / 2], any = 0;
        loadLanes(words, row + g * W);
        for (const std::uint64_t word : words) any |= word;
        if (any != 0) {
          Float more;
          loadLanes(more, row + g * W);
          sum[g] += more;
          expOfMinus<Float, Int>(sum[g], passed[g]);
        }
        storeLanes(row + g * W, passed[g]);
      }
    }
  }
}

#if defined(__x86_64__)
COIF_TARGET_16_LANES void columns16(float* cells, std::size_t width, std::size_t layers, std::size_t first) {
  columns<16>(cells, width, layers, first);
}
COIF_TARGET_8_LANES void columns8(float* cells, std::size_t width, std::size_t layers, std::size_t first) {
  columns<8>(cells, width, layers, first);
}
#endif

}  // namespace

void transmittanceByColumns(float* cells, std::size_t width, std::size_t layers, std::size_t first,
                            int lanes) {
#if defined(__x86_64__)
  if (lanes == 16) return columns16(cells, width, layers, first);
  if (lanes == 8) return columns8(cells, width, layers, first);
#endif
  (void)lanes;
  columns<4>(cells, width, layers, first);
}

}  // namespace coif::light
