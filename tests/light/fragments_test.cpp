#include "coif/light/fragments.h"

#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <tuple>

#include "coif/light/opaque_map.h"
#include "light/light_fixture.h"

namespace coif {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct Plain {
  double depth = 0, alpha = 0;
};
using PlainMap = std::map<std::tuple<std::uint32_t, std::uint32_t>, Plain>;  ///< by segment and texel

/// The rule again, the slow way: every texel centre of every segment, no bands, no ranges.
PlainMap plainFragments(const StrandSet& set, const LightView& view) {
  PlainMap out;
  for (std::size_t s = 0; s < set.strandCount(); ++s) {
    for (std::uint64_t p = set.offsets[s]; p + 1 < set.offsets[s + 1]; ++p) {
      const Vec3 wa = set.points[p].cast<double>(), wb = set.points[p + 1].cast<double>();
      const Vec3 a = view.project(wa), b = view.project(wb);
      const bool swap = std::abs(b.x() - a.x()) < std::abs(b.y() - a.y());
      const int major = swap ? 1 : 0;
      for (int i = 0; i < view.size; ++i) {
        const double centre = i + 0.5;
        if (centre < std::min(a[major], b[major]) || centre >= std::max(a[major], b[major])) continue;
        // The point of the segment that projects to this centre, by bisection in space.
        double lo = 0, hi = 1;
        for (int k = 0; k < 80; ++k) {
          const double mid = 0.5 * (lo + hi);
          const double at = view.project(wa + mid * (wb - wa))[major];
          ((at < centre) == (a[major] < b[major]) ? lo : hi) = mid;
        }
        const Vec3 at = view.project(wa + lo * (wb - wa));
        const int j = int(std::floor(at[1 - major]));
        if (j < 0 || j >= view.size) continue;
        const double slope = (b[1 - major] - a[1 - major]) / (b[major] - a[major]);
        const double width = (1 - lo) * double(set.widths[p]) + lo * double(set.widths[p + 1]);
        const double alpha = width / view.texelAt(at.z()) * std::sqrt(1 + slope * slope);
        const int x = swap ? j : i, y = swap ? i : j;
        out[{std::uint32_t(p), std::uint32_t(y * view.size + x)}] = {at.z(), std::min(alpha, 1 - 0x1p-24)};
      }
    }
  }
  return out;
}

void expectSame(const StrandSet& set, const LightView& view) {
  const PlainMap plain = plainFragments(set, view);
  const auto stream = FragmentStream::make(set, view);
  ASSERT_TRUE(stream.ok());
  const std::vector<Fragment> fragments = collect(*stream);
  EXPECT_EQ(fragments.size(), plain.size());
  for (const Fragment& f : fragments) {
    const auto at = plain.find({f.point, f.texel});
    ASSERT_NE(at, plain.end());
    EXPECT_NEAR(f.depth, at->second.depth, 1e-6 * view.depthRange);  // depth is a float
    EXPECT_NEAR(f.alpha, at->second.alpha, 1e-6);
  }
}

TEST(Fragments, AreThoseOfThePlainRuleForADistantLight) {
  const StrandSet set = wavyStrands(60, 0.002f);
  expectSame(set, squareView(64));
  expectSame(set, distantLightView(Vec3(0.3, 0.8, -0.5), {Vec3::Zero(), Vec3::Ones()}, 47));
}

TEST(Fragments, AreThoseOfThePlainRuleForAPointLight) {
  const StrandSet set = wavyStrands(60, 0.002f);
  expectSame(set, pointLightView(Vec3(0.4, 2.2, -0.8), {Vec3::Zero(), Vec3::Ones()}, 47));
}

TEST(Fragments, SummedCoverageIsWidthTimesProjectedLength) {
  const StrandSet set = wavyStrands(400, 1e-4f);
  const LightView view = squareView(128);
  double covered = 0, expected = 0;
  const FragmentStream stream = FragmentStream::make(set, view).value();
  for (const Fragment& f : collect(stream)) covered += f.alpha;
  for (std::size_t s = 0; s < set.strandCount(); ++s) {
    const auto points = set.strand(s);
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      const Vec3 d = view.project(points[i + 1].cast<double>()) - view.project(points[i].cast<double>());
      expected += 1e-4 / view.texel * d.head<2>().norm();
    }
  }
  // Segments end between centres: an end is off by 1/√12 fragments on average, which partly cancels at the
  // joints; 400 strands of ~60 fragments leave 2 · 0.29 · √400 / 24 000 ≈ 5e-4, and four times that is let
  // pass.
  EXPECT_NEAR(covered / expected, 1, 2e-3);
}

TEST(Fragments, JointOnATexelCentreIsCountedOnce) {
  const LightView view = squareView(8);
  for (const bool reversed : {false, true}) {
    StrandSet set;
    std::vector<Vec3f> points{Vec3f(0.0625f, 0.3f, 0.5f), Vec3f(0.4375f, 0.3f, 0.5f),
                              Vec3f(0.8125f, 0.3f, 0.5f)};
    if (reversed) std::swap(points[0], points[2]);
    addStrand(set, points, 0.01f);
    const FragmentStream stream = FragmentStream::make(set, view).value();
    EXPECT_EQ(collect(stream).size(), 6u);  // centres 0.0625, …, 0.6875: [min, max) leaves out 0.8125
  }
}

TEST(Fragments, WideHairIsClampedBelowOpaque) {
  StrandSet set;
  const LightView view = squareView(4);
  addAcross(set, view, 1, 1, 0.5, 100);
  const FragmentStream stream = FragmentStream::make(set, view).value();
  const auto fragments = collect(stream);
  ASSERT_EQ(fragments.size(), 1u);
  EXPECT_EQ(fragments[0].alpha, kGreatestAlpha);
  EXPECT_NEAR(fragments[0].beta(), 24 * std::log(2.0), 1e-5);
}

TEST(Fragments, ZeroWidthAndTransparentHairLeaveNone) {
  StrandSet set;
  const LightView view = squareView(4);
  addAcross(set, view, 1, 1, 0.5, 0);
  EXPECT_TRUE(collect(FragmentStream::make(set, view).value()).empty());
  addAcross(set, view, 1, 1, 0.5, 0.5);
  set.transparencies.assign(set.points.size(), 1.0f);
  EXPECT_TRUE(collect(FragmentStream::make(set, view).value()).empty());
  set.transparencies.assign(set.points.size(), 0.5f);
  const auto half = collect(FragmentStream::make(set, view).value());
  ASSERT_EQ(half.size(), 1u);
  EXPECT_NEAR(half[0].alpha, 0.25, 1e-6);
}

TEST(Fragments, StrandThatIsNotFiniteIsDroppedAndCounted) {
  const LightView view = squareView(16);
  StrandSet set = wavyStrands(5, 0.01f);
  const std::size_t whole = collect(FragmentStream::make(set, view).value()).size();
  StrandSet without = set;
  addStrand(set, {Vec3f(0, 0, 0), Vec3f(kNan, 0.5f, 0), Vec3f(1, 1, 0)}, 0.1f);
  addStrand(set, {Vec3f(0, 0, 0), Vec3f(1, 0.5f, 0)}, std::numeric_limits<float>::infinity());
  const FragmentStream stream = FragmentStream::make(set, view).value();
  EXPECT_EQ(stream.droppedStrands(), 2u);
  EXPECT_EQ(collect(stream).size(), whole);
}

TEST(Fragments, SegmentThroughAPointLightKeepsThePartInFront) {
  LightView view = squareView(32);
  view.perspective = true;
  view.texel = 2.0 / 32;  // 45° to either side at depth 1
  StrandSet set;
  addStrand(set, {Vec3f(0.5f, 0.5f, 2), Vec3f(0.6f, 0.5f, 0)}, 1e-3f);  // eye at z = 1
  addStrand(set, {Vec3f(0.5f, 0.5f, 2), Vec3f(0.6f, 0.5f, 1.5f)}, 1e-3f);
  const FragmentStream stream = FragmentStream::make(set, view).value();
  const auto fragments = collect(stream);
  EXPECT_FALSE(fragments.empty());
  for (const Fragment& f : fragments) {
    EXPECT_GE(f.depth, kNearFraction * view.depthRange);
    EXPECT_EQ(f.point, 0u);
    EXPECT_GT(f.along, 0.49f);
    EXPECT_TRUE(std::isfinite(f.alpha));
  }
}

TEST(Fragments, HugeCoordinatesAreCutToTheMap) {
  StrandSet set;
  addStrand(set, {Vec3f(-1e30f, 0.3f, 0.5f), Vec3f(1e30f, 0.3f, 0.5f)}, 1e-3f);
  addStrand(set, {Vec3f(-1e30f, -1e30f, 0.5f), Vec3f(-1e30f, 3e38f, 0.5f)}, 1e-3f);
  const auto fragments = collect(FragmentStream::make(set, squareView(16)).value());
  EXPECT_EQ(fragments.size(), 16u);
}

TEST(Fragments, OrderWithinATexelDoesNotDependOnThreads) {
  const StrandSet set = wavyStrands(9000, 0.001f);  // several chunks
  const LightView view = squareView(64);
  std::vector<std::vector<std::vector<float>>> lists;
  for (const int threads : {1, 2, 5}) {
    Context context;
    context.threads = threads;
    const FragmentStream stream = FragmentStream::make(set, view, {}, context).value();
    std::vector<std::vector<float>> texels(stream.texelCount());
    stream.forEach(context, [&](const Fragment& f) { texels[f.texel].push_back(f.depth); });
    lists.push_back(std::move(texels));
  }
  EXPECT_TRUE(lists[0] == lists[1] && lists[0] == lists[2]);
}

TEST(Fragments, SuggestedMapSizeIsTenWidthsATexel) {
  StrandSet set = wavyStrands(20, 0.001f);
  const Box box{Vec3::Zero(), Vec3(1, 0, 0)};
  EXPECT_NEAR(suggestedMapSize(set, box), 100, 1);  // a float's 0.001
  EXPECT_EQ(suggestedMapSize(set, box, 64), 64);
  set.widths.assign(set.points.size(), 0.0f);
  set.metersPerUnit = 1;
  EXPECT_EQ(suggestedMapSize(set, box), 512);  // 0.08 mm hair in a box of a metre
  EXPECT_EQ(suggestedMapSize(StrandSet{}, Box{}), 16);
}

TEST(Fragments, BadOptionsAreRefused) {
  const StrandSet set = wavyStrands(2, 0.01f);
  EXPECT_FALSE(FragmentStream::make(set, squareView(8), {.opacity = 1.5}).ok());
  EXPECT_FALSE(FragmentStream::make(set, squareView(8), {.opacity = kNan}).ok());
  EXPECT_FALSE(FragmentStream::make(set, squareView(8), {.widthScale = -1}).ok());
  LightView none = squareView(8);
  none.size = 0;
  EXPECT_FALSE(FragmentStream::make(set, none).ok());
}

PolygonMesh quadAt(double z) {
  PolygonMesh mesh;
  mesh.positions = {Vec3(0.25, 0.25, z), Vec3(0.75, 0.25, z), Vec3(0.75, 0.75, z), Vec3(0.25, 0.75, z)};
  mesh.addFace(std::vector<std::uint32_t>{0, 1, 2, 3});
  return mesh;
}

TEST(OpaqueMap, HoldsTheNearestSurfaceAndHidesWhatIsBehind) {
  PolygonMesh mesh = quadAt(0.5);
  for (const Vec3& p : quadAt(0.7).positions) mesh.positions.push_back(p);
  mesh.addFace(std::vector<std::uint32_t>{4, 5, 6, 7});
  const LightView view = squareView(16);
  const OpaqueMap map = OpaqueMap::make(mesh, view).value();
  int covered = 0;
  for (const float d : map.depths()) {
    covered += std::isfinite(d);
    if (std::isfinite(d)) {
      EXPECT_NEAR(d, 0.3f, 1e-6f);
    }
  }
  EXPECT_EQ(covered, 64);
  EXPECT_TRUE(map.blocks(Vec3(0.5, 0.5, 0.6)));
  EXPECT_FALSE(map.blocks(Vec3(0.5, 0.5, 0.75)));
  EXPECT_FALSE(map.blocks(Vec3(0.1, 0.5, 0.1)));
  EXPECT_FALSE(map.blocks(Vec3(5, 5, 0)));  // off the map

  StrandSet set;
  addAcross(set, view, 8, 8, 0.2, 0.1);
  addAcross(set, view, 8, 8, 0.4, 0.1);
  addAcross(set, view, 1, 1, 0.4, 0.1);
  FragmentOptions options;
  options.opaque = &map;
  EXPECT_EQ(collect(FragmentStream::make(set, view, options).value()).size(), 2u);
}

TEST(OpaqueMap, SurfaceDoesNotShadowItself) {
  // A slanted plane under both kinds of light, asked at its own points.
  PolygonMesh mesh;
  mesh.positions = {Vec3(-1, -1, 0), Vec3(2, -1, 1.5), Vec3(2, 2, 3), Vec3(-1, 2, 1.5)};
  mesh.addFace(std::vector<std::uint32_t>{0, 1, 2, 3});
  const Box box = bounds(mesh.positions);
  for (const LightView& view :
       {distantLightView(Vec3(-0.2, 0.1, 1), box, 64), pointLightView(Vec3(-2, 0, 9), box, 64)}) {
    const OpaqueMap map = OpaqueMap::make(mesh, view).value();
    int shadowed = 0;
    for (int i = 0; i < 1000; ++i) {
      const CounterRandom random(3, std::uint64_t(i));
      const double u = 0.02 + 0.96 * random.uniform(0), v = 0.02 + 0.96 * random.uniform(1);
      const Vec3 p = mesh.positions[0] + u * (mesh.positions[1] - mesh.positions[0]) +
                     v * (mesh.positions[3] - mesh.positions[0]);
      shadowed += map.blocks(p);
    }
    // Under a point light the push is linear in the texel while depth is not: a rounding's worth of points.
    EXPECT_LE(shadowed, view.perspective ? 5 : 0);
  }
}

TEST(OpaqueMap, TriangleAroundAPointLightIsCutNotLost) {
  PolygonMesh mesh;  // reaches behind the light at z = 1
  mesh.positions = {Vec3(-50, 0, 3), Vec3(50, 0, 3), Vec3(0, 0.5, -100)};
  mesh.addFace(std::vector<std::uint32_t>{0, 1, 2});
  LightView view = squareView(32);
  view.perspective = true;
  view.texel = 2.0 / 32;
  const OpaqueMap map = OpaqueMap::make(mesh, view).value();
  EXPECT_TRUE(map.blocks(Vec3(0.5, -1, -10)));  // below the triangle, which is near y = 0 there
}

}  // namespace
}  // namespace coif
