#include "coif/light/image_metrics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "coif/base/random.h"
#include "coif/base/vec.h"

namespace coif {
namespace {

FloatImage constant(int width, int height, Vec3f color) {
  FloatImage image(width, height);
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    for (std::size_t c = 0; c < 3; ++c) image.rgba[i + c] = color[int(c)];
    image.rgba[i + 3] = 1;
  }
  return image;
}

FloatImage noise(int width, int height, std::uint64_t seed) {
  FloatImage image = constant(width, height, Vec3f::Zero());
  for (std::size_t i = 0; i < image.rgba.size(); ++i) {
    if (i % 4 != 3) image.rgba[i] = float(CounterRandom(seed, i).uniform(0));
  }
  return image;
}

TEST(SquaredError, IsWhatTheDefinitionSays) {
  const FloatImage a = constant(7, 5, Vec3f(0.5f, 1, 2)), b = constant(7, 5, Vec3f(0.25f, 1, 0));
  EXPECT_NEAR(meanSquaredError(a, b).value(), (0.0625 + 0 + 4) / 3, 1e-12);
  EXPECT_NEAR(relativeMse(a, b, 0.01).value(), (0.0625 / 0.0725 + 0 + 4 / 0.01) / 3, 1e-9);
  EXPECT_EQ(meanSquaredError(a, a).value(), 0);
  EXPECT_FALSE(meanSquaredError(a, constant(5, 7, Vec3f::Zero())).ok());
  FloatImage broken = a;
  broken.rgba[4] = NAN;
  EXPECT_FALSE(relativeMse(a, broken).ok());
}

TEST(Flip, OfEqualPicturesIsZeroAndOrderDoesNotMatter) {
  const FloatImage a = noise(60, 40, 1), b = noise(60, 40, 2);
  EXPECT_EQ(flip(a, a)->mean, 0);
  const auto there = flip(a, b), back = flip(b, a);
  ASSERT_TRUE(there.ok() && back.ok());
  EXPECT_GT(there->mean, 0.05);
  EXPECT_EQ(there->map, back->map);  // the LDR measure is symmetric
}

TEST(Flip, OfFlatPicturesFollowsFromThePapersConstants) {
  // Black to white: HyAB 100, so 100^0.7 = 25.119; the most that sRGB holds is HyAB(green, blue) = 203.1
  // after Hunt's correction, to the 0.7 41.25; 0.95 + 0.05 (25.119 - 16.50) / (41.25 - 16.50) = 0.9674.
  const FloatImage black = constant(20, 20, Vec3f::Zero()), white = constant(20, 20, Vec3f::Ones());
  const auto error = flip(white, black);
  ASSERT_TRUE(error.ok());
  EXPECT_NEAR(error->mean, 0.9674, 2e-4);  // Lab of the primaries to four digits
  for (const float e : error->map) EXPECT_NEAR(e, error->mean, 1e-6);
  EXPECT_NEAR(flip(constant(20, 20, Vec3f(0, 1, 0)), constant(20, 20, Vec3f(0, 0, 1)))->mean, 1, 1e-9);
}

TEST(Flip, ASinglePixelIsSeenOnlyAroundIt) {
  const FloatImage grey = constant(81, 81, Vec3f::Constant(0.2f));
  FloatImage dotted = grey;
  dotted.at(40, 40)[0] = dotted.at(40, 40)[1] = dotted.at(40, 40)[2] = 1;
  const auto error = flip(dotted, grey);
  ASSERT_TRUE(error.ok());
  EXPECT_GT(error->map[40 * 81 + 40], 0.3);
  for (int x : {0, 29, 51, 80})
    EXPECT_LT(error->map[std::size_t(40 * 81 + x)], 1e-6);  // 10 pixels: the widest kernel
  EXPECT_LT(flip(dotted, grey, 200)->map[40 * 81 + 40], error->map[40 * 81 + 40]);
}

TEST(Flip, ThreadsDoNotMatterAndNonsenseIsRefused) {
  const FloatImage a = noise(50, 33, 1), b = noise(50, 33, 2);
  Context one, two;
  one.threads = 1, two.threads = 2;
  EXPECT_EQ(flip(a, b, 67, one)->map, flip(a, b, 67, two)->map);
  EXPECT_FALSE(flip(a, b, 0).ok());
  EXPECT_FALSE(flip(a, noise(33, 50, 2)).ok());
}

}  // namespace
}  // namespace coif
