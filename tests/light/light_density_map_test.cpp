#include "coif/light/light_density_map.h"

#include <gtest/gtest.h>

#include <limits>

#include "coif/light/visibility.h"
#include "light/light_fixture.h"

namespace coif {
namespace {

const Box kUnit{Vec3::Zero(), Vec3::Ones()};

/// Thin hairs along x through z in [lo, hi], evenly spread: coverage `alpha` in all when seen from +z.
StrandSet slab(double lo, double hi, double alpha, int count) {
  StrandSet set;
  const float width = float(alpha / count);  // Σ length 1 · width over an area of 1
  for (int i = 0; i < count; ++i) {
    const double y = std::fmod((i + 0.5) * 0.61803398875, 1.0), z = lo + (hi - lo) * (i + 0.5) / count;
    addStrand(set, {Vec3f(0, float(y), float(z)), Vec3f(1, float(y), float(z))}, width);
  }
  return set;
}

LightDensityMap make(const StrandSet& set, const LightView& view, LightDensityOptions options = {},
                     int threads = 0) {
  Context context;
  context.threads = threads;
  const FragmentStream stream = FragmentStream::make(set, view, {}, context).value();
  auto map = LightDensityMap::make(stream, options, context);
  EXPECT_TRUE(map.ok()) << (map.ok() ? "" : map.error().text());
  return std::move(map).value();
}

TEST(LightDensityMap, SlabThickensLinearlyAndIsClearInFront) {
  const StrandSet set = slab(0.3, 0.7, 2.0, 40000);
  const LightDensityMap map = make(set, distantLightView(Vec3(0, 0, 1), kUnit, 64), {.log2Size = 6});
  EXPECT_DOUBLE_EQ(map.transmittance(Vec3(0.5, 0.5, 0.9)), 1);
  // In a column of cells the hairs' number is even to a few of 40 000 / 61; the slab's ends lie within a
  // cell.
  EXPECT_NEAR(map.transmittance(Vec3(0.5, 0.5, 0.1)), std::exp(-2.0), 0.01);
  for (const double z : {0.4, 0.5, 0.6}) {
    EXPECT_NEAR(map.transmittance(Vec3(0.5, 0.5, z)), std::exp(-2.0 * (0.7 - z) / 0.4), 0.02) << z;
  }
}

TEST(LightDensityMap, HairAlongTheLightCastsNothing) {
  StrandSet set;
  for (int i = 0; i < 100; ++i) {
    addStrand(set, {Vec3f(0.5f, 0.01f * float(i), 0), Vec3f(0.5f, 0.01f * float(i), 1)}, 0.1f);
  }
  const LightDensityMap along = make(set, distantLightView(Vec3(0, 0, 1), kUnit, 64), {.log2Size = 5});
  EXPECT_NEAR(along.transmittance(Vec3(0.5, 0.5, 0)), 1, 1e-3);
  const LightDensityMap across = make(set, distantLightView(Vec3(1, 0, 0), kUnit, 64), {.log2Size = 5});
  EXPECT_LT(across.transmittance(Vec3(0, 0.5, 0.5)), 1e-3);  // ten units of width over one of height
}

TEST(LightDensityMap, ApproachesTheTruthWithItsCells) {
  const StrandSet set = slab(0.2, 0.8, 3.0, 60000);
  const LightView view = distantLightView(Vec3(0.4, 0.7, 1), kUnit, 48);
  const FragmentStream stream = FragmentStream::make(set, view).value();
  VisibilityOptions exact;
  exact.method = VisibilityMethod::Exact;
  exact.filter = true;
  const auto truth = buildVisibility(stream, exact).value();
  std::vector<double> errors;
  for (const int log2 : {3, 4, 5, 6}) {
    const LightDensityMap map = make(set, view, {.log2Size = log2});
    double sum = 0;
    for (std::uint64_t i = 0; i < 2000; ++i) {
      const CounterRandom random(3, i);
      const Vec3 p(0.1 + 0.8 * random.uniform(0), 0.1 + 0.8 * random.uniform(1), random.uniform(2));
      sum += std::abs(map.transmittance(p) - truth->transmittance(p)) / 2000;
    }
    errors.push_back(sum);
  }
  // T is continuous with a kink at the faces of the slab, and interpolated: better than first order until the
  // truth's own texels show.
  for (std::size_t i = 1; i < errors.size(); ++i) EXPECT_LT(errors[i], 0.55 * errors[i - 1]) << i;
  EXPECT_LT(errors.back(), 0.02);
}

TEST(LightDensityMap, WrapsSoThatMovedHairGivesTheSame) {
  StrandSet set = wavyStrands(400, 0.02f);
  const LightView view = distantLightView(Vec3(0, 0, 1), kUnit, 32);
  const double cell = 0.0625;
  const LightDensityMap still = make(set, view, {.log2Size = 5, .cell = cell});
  // Whole cells in every direction, below zero too: exact in floats, since cells are powers of two.
  for (const Vec3& shift : {Vec3(-37, 5, 11), Vec3(64, -64, -3)}) {
    StrandSet moved = set;
    for (Vec3f& p : moved.points) p += (cell * shift).cast<float>();
    const LightDensityMap map = make(moved, view, {.log2Size = 5, .cell = cell});
    for (std::uint64_t i = 0; i < 200; ++i) {
      const CounterRandom random(5, i);
      const Vec3 p(random.uniform(0), random.uniform(1), random.uniform(2));
      // Floats of the moved points have three digits less.
      EXPECT_NEAR(still.transmittance(p), map.transmittance(p + cell * shift), 1e-4);
    }
  }
}

TEST(LightDensityMap, UpdateEqualsANewMap) {
  const LightView view = distantLightView(Vec3(0.2, 1, 0.3), kUnit, 32);
  const StrandSet first = wavyStrands(300, 0.02f, 1), second = wavyStrands(200, 0.03f, 2);
  const LightDensityOptions options{.log2Size = 5, .cell = 0.08};
  LightDensityMap map = make(first, view, options);
  ASSERT_TRUE(map.update(FragmentStream::make(second, view).value()).ok());
  const LightDensityMap fresh = make(second, view, options);
  for (std::uint64_t i = 0; i < 300; ++i) {
    const CounterRandom random(7, i);
    const Vec3 p(random.uniform(0), random.uniform(1), random.uniform(2));
    EXPECT_NEAR(map.transmittance(p), fresh.transmittance(p), 1e-5);  // the same cells from another base
  }
}

TEST(LightDensityMap, HairLongerThanTheBoxIsRefusedOrTheCellsGrow) {
  const StrandSet set = wavyStrands(50, 0.01f);
  const LightView view = distantLightView(Vec3(0, 1, 0), kUnit, 32);
  const FragmentStream stream = FragmentStream::make(set, view).value();
  const auto refused = LightDensityMap::make(stream, {.log2Size = 4, .cell = 0.01, .grows = false});
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::TooLarge);
  const auto grown = LightDensityMap::make(stream, {.log2Size = 4, .cell = 0.01});
  ASSERT_TRUE(grown.ok());
  EXPECT_EQ(grown->cell(), 0.08);
  EXPECT_FALSE(LightDensityMap::make(stream, {.log2Size = 2}).ok());
}

TEST(LightDensityMap, PointLightSeesASlabAsADistantOneDoes) {
  // Far away, rays are parallel; near, the slab is crossed at an angle whose cosine the coverage on the map's
  // plane does not know.
  const StrandSet set = slab(0.3, 0.7, 1.5, 40000);
  const LightDensityMap far = make(set, pointLightView(Vec3(0.5, 0.5, 30), kUnit, 64), {.log2Size = 6});
  for (const double z : {0.9, 0.6, 0.5, 0.4, 0.1}) {
    const double inside = std::clamp((0.7 - z) / 0.4, 0.0, 1.0);
    EXPECT_NEAR(far.transmittance(Vec3(0.5, 0.5, z)), std::exp(-1.5 * inside), 0.03) << z;
  }
  const LightView nearView = pointLightView(Vec3(0.5, 0.5, 2), kUnit, 128);
  const LightDensityMap near = make(set, nearView, {.log2Size = 6});
  const FragmentStream stream = FragmentStream::make(set, nearView).value();
  VisibilityOptions exact;
  exact.method = VisibilityMethod::Exact;
  exact.filter = true;
  const auto truth = buildVisibility(stream, exact).value();
  double error = 0;
  for (std::uint64_t i = 0; i < 500; ++i) {
    const CounterRandom random(9, i);
    const Vec3 p(0.2 + 0.6 * random.uniform(0), 0.2 + 0.6 * random.uniform(1), random.uniform(2));
    error += std::abs(near.transmittance(p) - truth->transmittance(p)) / 500;
  }
  EXPECT_LT(error, 0.02);  // cells of a 64th, T up to 1: the truth's texels hold about ten hairs
}

TEST(LightDensityMap, TwoLightsAreTwoMaps) {
  const StrandSet set = slab(0.4, 0.6, 2.0, 20000);
  const LightDensityMap front = make(set, distantLightView(Vec3(0, 0, 1), kUnit, 64), {.log2Size = 6});
  const LightDensityMap back = make(set, distantLightView(Vec3(0, 0, -1), kUnit, 64), {.log2Size = 6});
  const Vec3 ahead(0.5, 0.5, 0.8), behind(0.5, 0.5, 0.2);
  EXPECT_NEAR(front.transmittance(ahead), 1, 1e-6);
  EXPECT_NEAR(back.transmittance(behind), 1, 1e-6);
  EXPECT_NEAR(front.transmittance(behind), back.transmittance(ahead), 0.01);  // columns begin elsewhere
}

TEST(LightDensityMap, ExtremesGiveNumbers) {
  StrandSet broken = wavyStrands(3, 0.1f);
  broken.points[4].x() = std::numeric_limits<float>::quiet_NaN();
  for (const StrandSet& set : {StrandSet{}, wavyStrands(1, 0.0f), wavyStrands(30, 5.0f), broken}) {
    for (const LightView& view :
         {distantLightView(Vec3(0, 1, 0), kUnit, 16), pointLightView(Vec3(0.5, 0.5, 0.5), kUnit, 16),
          pointLightView(Vec3(0.5, 3, 0.5), kUnit, 16)}) {
      const LightDensityMap map = make(set, view, {.log2Size = 3});
      for (std::uint64_t i = 0; i < 100; ++i) {
        const CounterRandom random(3, i);
        const Vec3 p(3 * random.uniform(0) - 1, 3 * random.uniform(1) - 1, 3 * random.uniform(2) - 1);
        const double t = map.transmittance(p);
        EXPECT_TRUE(t >= 0 && t <= 1);
      }
      EXPECT_EQ(map.transmittance(Vec3(NAN, 0, 0)), 1);
      EXPECT_TRUE(std::isfinite(map.transmittance(Vec3(1e300, 0, 0))));
    }
  }
  EXPECT_EQ(make(broken, distantLightView(Vec3(0, 1, 0), kUnit, 16)).droppedStrands(), 1u);
}

TEST(LightDensityMap, SameBytesForAnyNumberOfThreads) {
  const StrandSet set = wavyStrands(3000, 0.005f);
  const LightView view = distantLightView(Vec3(0.3, 1, 0.5), kUnit, 64);
  const LightDensityMap one = make(set, view, {.log2Size = 6}, 1), more = make(set, view, {.log2Size = 6}, 5);
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const CounterRandom random(21, i);
    const Vec3 p(random.uniform(0), random.uniform(1), random.uniform(2));
    ASSERT_EQ(one.transmittance(p), more.transmittance(p));
  }
}

}  // namespace
}  // namespace coif
