#include "light/light_columns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "coif/base/lanes.h"
#include "coif/base/random.h"

namespace coif::light {
namespace {

constexpr std::size_t kWidth = 2048 + 16, kLayers = 32, kFirst = 5;  // more than one strip, and a part of one

/// Optical depths of cells, many of them empty, some of them of no light at all.
std::vector<float> someHair() {
  std::vector<float> cells(kWidth * kLayers, 0.0f);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const CounterRandom random(7, i);
    const bool emptyGroup = i / 64 % 3 == 0;
    if (!emptyGroup && random.uniform(0) < 0.4) cells[i] = float(std::pow(10.0, 6 * random.uniform(1) - 4));
  }
  return cells;
}

std::vector<float> passed(std::vector<float> depths, int lanes) {
  std::vector<float> out(depths.size());
  transmittanceByColumns(depths.data(), out.data(), kWidth, kLayers, kFirst, lanes);
  EXPECT_EQ(std::ranges::count(depths, 0.0f), std::ptrdiff_t(depths.size()));
  return out;
}

TEST(LightColumns, SameBytesForAnyNumberOfLanes) {
  const std::vector<float> four = passed(someHair(), 4);
  for (int lanes = 8; lanes <= widestLanes(); lanes *= 2) ASSERT_EQ(four, passed(someHair(), lanes)) << lanes;
}

TEST(LightColumns, AreTheExponentialsOfRunningSums) {
  const std::vector<float> hair = someHair(), out = passed(hair, widestLanes());
  double worst = 0;
  for (std::size_t column = 0; column < kWidth; ++column) {
    float sum = 0;
    for (std::size_t layer = 0; layer < kLayers; ++layer) {
      const std::size_t at = (kFirst + layer) % kLayers * kWidth + column;
      sum += hair[at];
      const double truth = std::exp(-double(sum)), mine = double(out[at]);
      if (truth > 1e-37) {
        // The polynomial's 1.1e-7, the rounding of x / ln 2, half a unit of 2⁻²³ of it, and of eight steps.
        const double allowed = 1.1e-7 + 8 * 0x1p-24 + double(sum) * 0x1p-23;
        worst = std::max(worst, std::abs(mine / truth - 1));
        ASSERT_NEAR(mine / truth, 1, allowed) << sum;
      } else {
        ASSERT_TRUE(mine >= 0 && mine < 2e-37) << sum;
      }
    }
  }
  EXPECT_GT(worst, 1e-7);  // places where the polynomial is off were met
}

}  // namespace
}  // namespace coif::light
