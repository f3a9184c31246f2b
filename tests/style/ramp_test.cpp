#include "coif/style/ramp.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "coif/base/random.h"

namespace coif {
namespace {

TEST(Ramp, LinearIsStraightBetweenPointsAndLevelOutside) {
  const RampCurve ramp(Ramp{{{0.25, 0.5}, {0.5, 1}, {1, 0}}, RampShape::Linear});
  EXPECT_EQ(ramp(0), 0.5);
  EXPECT_EQ(ramp(0.25), 0.5);
  EXPECT_EQ(ramp(0.375), 0.75);
  EXPECT_EQ(ramp(0.75), 0.5);
  EXPECT_EQ(ramp(2), 0);
  EXPECT_EQ(ramp(-1), 0.5);
  EXPECT_EQ(ramp.greatest(), 1);
  EXPECT_EQ(RampCurve(Ramp{{{0.3, 0.7}}, RampShape::Smooth})(0.9), 0.7) << "one point is a constant";
}

TEST(Ramp, SmoothOfTwoPointsIsStraightAndOfEvenSlopesToo) {
  const RampCurve two(Ramp{{{0, 0.2}, {1, 0.8}}, RampShape::Smooth});
  const RampCurve three(Ramp{{{0, 0}, {0.5, 0.5}, {1, 1}}, RampShape::Smooth});
  for (double x = 0; x <= 1; x += 0.0625) {
    EXPECT_NEAR(two(x), 0.2 + 0.6 * x, 1e-15) << x;
    EXPECT_NEAR(three(x), x, 1e-15) << x;
  }
}

TEST(Ramp, SmoothIsFritschAndCarlsonsCubic) {
  // Slopes: chords 2 and 0.5, so 2 and 0.5 at the ends, 1.25 between; all ratios lie within the circle
  // of 3 but the first one's (1, 0.625) and the second's (2.5, 1), which do too.
  const RampCurve ramp(Ramp{{{0, 0}, {0.25, 0.5}, {1, 0.875}}, RampShape::Smooth});
  // Hermite at a segment's middle: (y0 + y1)/2 + h (m0 − m1)/8.
  EXPECT_DOUBLE_EQ(ramp(0.125), 0.25 + 0.25 * (2 - 1.25) / 8);
  EXPECT_DOUBLE_EQ(ramp(0.625), 0.6875 + 0.75 * (1.25 - 0.5) / 8);
  EXPECT_EQ(ramp(0.25), 0.5);
}

TEST(Ramp, SmoothNeverOvershoots) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const CounterRandom random(seed);
    Ramp data;
    data.points.clear();
    const int count = 2 + int(random.below(0, 8));
    for (int i = 0; i < count; ++i)
      data.points.push_back({(i + 0.9 * random.uniform(2 * i + 1)) / count, random.uniform(2 * i + 2)});
    ASSERT_TRUE(validate(data).ok());
    const RampCurve ramp(data);
    for (std::size_t i = 0; i + 1 < data.points.size(); ++i) {
      const RampPoint &a = data.points[i], &b = data.points[i + 1];
      double before = a.y;
      for (int k = 0; k <= 40; ++k) {
        const double y = ramp(a.x + (b.x - a.x) * k / 40);
        // Monotone but for the rounding of a few products of numbers below 1.
        const double rise = b.y >= a.y ? y - before : before - y;
        EXPECT_GE(rise, -1e-15);
        before = y;
      }
      EXPECT_EQ(ramp(a.x), a.y);
    }
  }
}

TEST(Ramp, RefusesWhatIsNoFunction) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(validate(Ramp{{}, RampShape::Linear}).ok());
  EXPECT_FALSE(validate(Ramp{{{0.5, 0}, {0.5, 1}}, RampShape::Linear}).ok());
  EXPECT_FALSE(validate(Ramp{{{0.5, 0}, {0.25, 1}}, RampShape::Linear}).ok());
  EXPECT_FALSE(validate(Ramp{{{0, 1.5}}, RampShape::Linear}).ok());
  EXPECT_FALSE(validate(Ramp{{{nan, 1}}, RampShape::Linear}).ok());
  EXPECT_FALSE(validate(Ramp{{{0, nan}}, RampShape::Linear}).ok());
  Ramp many;
  many.points.clear();
  for (int i = 0; i <= 64; ++i) many.points.push_back({i / 64.0, 0});
  EXPECT_FALSE(validate(many).ok());
}

}  // namespace
}  // namespace coif
