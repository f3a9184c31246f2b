#include "coif/strands/sampler.h"

#include <gtest/gtest.h>

#include "coif/strands/grow.h"
#include "coif/strands/hausdorff.h"
#include "coif/strands/strand_stats.h"
#include "sample_meshes.h"

namespace coif {
namespace {

std::vector<Vec3> widened(std::span<const Vec3f> points) {
  std::vector<Vec3> out;
  for (const Vec3f& p : points) out.push_back(p.cast<double>());
  return out;
}

/// The strand's own spline at 4096 points, from its weights, in double.
std::vector<Vec3> truthOf(const HairMesh& mesh, const StrandSet& strands, std::size_t s, Knots knots) {
  const Bundle& bundle = mesh.bundles()[mesh.indexOf(BundleId(strands.rootFaces[s]))];
  std::vector<Vec3> control(bundle.height() + 1, Vec3::Zero());
  std::vector<double> lengths(bundle.height(), 0.0);
  for (std::uint32_t k = 0; k <= bundle.height(); ++k) {
    for (std::uint32_t i = 0; i < bundle.corners; ++i) {
      control[k] += double(strands.weights[strands.weightOffsets[s] + i]) * mesh.position(bundle.face(k)[i]);
      if (k > 0)
        lengths[k - 1] += (mesh.position(bundle.face(k)[i]) - mesh.position(bundle.face(k - 1)[i])).norm();
    }
  }
  const SplineTable table(knotIntervals(lengths, knots), evenParameters(bundle.height(), 4096));
  std::vector<Vec3> out(4096, Vec3::Zero());
  for (std::size_t p = 0; p < out.size(); ++p) {
    for (std::size_t k = 0; k < control.size(); ++k) out[p] += table.row(p)[k] * control[k];
  }
  return out;
}

// Floats of coordinates below 10 add 2e-6 to the bound.
TEST(Sampler, ToleranceBoundsTheChordErrorOfEveryStrand) {
  const HairMesh mesh = samples::grid(3, 3, 5, 0.35);
  for (const Knots knots : {Knots::Uniform, Knots::Centripetal, Knots::Chordal}) {
    std::uint64_t fewer = 0;
    for (const double tolerance : {3e-2, 3e-3, 3e-4}) {
      GrowOptions options;
      options.count = 60;
      options.tolerance = tolerance;
      options.knots = knots;
      const GrowResult result = grow(mesh, options).value();
      double worst = 0;
      for (std::size_t s = 0; s < 60; ++s) {
        worst = std::max(worst, oneSidedHausdorff(truthOf(mesh, result.strands, s, knots),
                                                  widened(result.strands.strand(s))));
      }
      EXPECT_LE(worst, tolerance + 2e-6);
      EXPECT_GE(worst, tolerance / 10) << "wasteful";
      EXPECT_GT(result.strands.pointCount(), 2 * fewer)
          << "points go with one over the root of the tolerance";
      fewer = result.strands.pointCount();
    }
  }
}

TEST(Sampler, ReportsTheChordErrorThatTheTruthHas) {
  const HairMesh mesh = samples::grid(3, 3, 5, 0.35);
  GrowOptions options;
  options.count = 32;  // as many as the report looks at
  options.points = 12;
  const GrowResult result = grow(mesh, options).value();
  double worst = 0;
  for (std::size_t s = 0; s < 32; ++s) {
    worst = std::max(worst, oneSidedHausdorff(truthOf(mesh, result.strands, s, Knots::Uniform),
                                              widened(result.strands.strand(s))));
  }
  const StrandStats stats = strandStats(result.strands);
  // The report measures each point against the chord of its own parameter, never below the true distance.
  EXPECT_GE(result.report.error.value * stats.box.diagonal(), 0.98 * worst);
  EXPECT_LE(result.report.error.value * stats.box.diagonal(), 1.5 * worst);
}

/// A coarse sphere above the xz grid's plane, so that roots are lifted on to it.
PolygonMesh dome(double radius, const Vec3& centre) {
  PolygonMesh mesh;
  constexpr std::uint32_t kRings = 24, kSides = 48;
  for (std::uint32_t r = 0; r <= kRings; ++r) {
    for (std::uint32_t s = 0; s < kSides; ++s) {
      const double a = 3.14159265358979 * (0.001 + 0.998 * r / kRings), b = 2 * 3.14159265358979 * s / kSides;
      mesh.positions.push_back(
          centre + radius * Vec3(std::sin(a) * std::sin(b), std::cos(a), std::sin(a) * std::cos(b)));
    }
  }
  for (std::uint32_t r = 0; r < kRings; ++r) {
    for (std::uint32_t s = 0; s < kSides; ++s) {
      const std::uint32_t t = (s + 1) % kSides;
      mesh.addFace(std::vector<std::uint32_t>{r * kSides + s, (r + 1) * kSides + s, (r + 1) * kSides + t,
                                              r * kSides + t});
    }
  }
  return mesh;
}

TEST(Sampler, LaysRootsOnTheHeadAndLeavesLaterControlPoints) {
  const HairMesh mesh = samples::grid(4, 4, 4, 0.1);
  const Surface head(dome(8, {2, -7.6, -2}));
  for (const bool adaptive : {false, true}) {
    GrowOptions options;
    options.count = 500;
    options.points = 33;
    if (adaptive) options.tolerance = 1e-3;
    const StrandSet plain = grow(mesh, options).value().strands;
    options.head = &head;
    const GrowResult result = grow(mesh, options).value();
    ASSERT_EQ(result.strands.ids, plain.ids);
    EXPECT_GT(result.report.maxRootLift, 0.1);
    for (std::size_t s = 0; s < 500; ++s) {
      const auto with = result.strands.strand(s), without = plain.strand(s);
      EXPECT_LE(head.nearest(with[0].cast<double>()).distance,
                1e-6 * head.size());  // the root is rounded to float
      EXPECT_EQ(with.back(), without.back());
      if (adaptive) continue;
      for (std::size_t p = 8; p < 33; ++p)
        EXPECT_EQ(with[p], without[p]) << "from the second control point on";
      const double lift = (with[0] - without[0]).norm();
      for (std::size_t p = 1; p < 8; ++p) {  // monotone fading
        EXPECT_LE((with[p] - without[p]).norm(), (with[p - 1] - without[p - 1]).norm() + 1e-6);
        EXPECT_NEAR((with[p] - without[p]).norm(), lift * (1 - p / 8.0) * (1 - p / 8.0) * (1 + p / 4.0),
                    2e-6);
      }
    }
  }
}

TEST(Sampler, ToleranceHoldsForLiftedStrands) {
  const HairMesh mesh = samples::grid(4, 4, 3, 0.1);
  const Surface head(dome(8, {2, -7.6, -2}));
  GrowOptions options;
  options.count = 100;
  options.tolerance = 1e-3;
  options.head = &head;
  const GrowResult result = grow(mesh, options).value();
  const StrandStats stats = strandStats(result.strands);
  EXPECT_LE(result.report.error.value * stats.box.diagonal(), 1e-3 + 2e-6);
  // Fewer strands are still a prefix, points and all.
  options.count = 37;
  const StrandSet few = grow(mesh, options).value().strands;
  for (std::size_t s = 0; s < 37; ++s) {
    EXPECT_TRUE(std::equal(few.strand(s).begin(), few.strand(s).end(), result.strands.strand(s).begin(),
                           result.strands.strand(s).end()));
  }
}

// Few strands a bundle take the other path through memory; the bytes are the same.
TEST(Sampler, BothPathsThroughMemoryAgree) {
  const HairMesh mesh = samples::grid(5, 5, 3, 0.2);
  const RootSet many = placeRoots(mesh, {.count = 25 * 64}).value(),
                few = placeRoots(mesh, {.count = 25 * 64 - 1}).value();
  const StrandSampler a(mesh, many, {}), b(mesh, few, {});
  std::vector<Vec3f> pointsA(a.pointCount()), pointsB(b.pointCount());
  a.evaluate(pointsA);
  b.evaluate(pointsB);
  EXPECT_TRUE(std::equal(pointsB.begin(), pointsB.end(), pointsA.begin()));
}

TEST(StrandStats, CountsAndMeasures) {
  StrandSet set;
  set.offsets = {0, 3, 5, 6, 8};
  set.points = {{0, 0, 0}, {3, 4, 0}, {3, 4, 2}, {1, 1, 1},
                {1, 1, 1}, {5, 5, 5}, {0, 0, 0}, {0, std::nanf(""), 0}};
  set.widths = {1, 2, 3, 1, 1, 1, 1, 0.5f};
  const StrandStats stats = strandStats(set);
  EXPECT_EQ(stats.strands, 4u);
  EXPECT_EQ(stats.points, 8u);
  EXPECT_EQ(stats.notFinite, 1u);
  EXPECT_EQ(stats.zeroLength, 3u);
  EXPECT_EQ(stats.fewestPoints, 1u);
  EXPECT_EQ(stats.mostPoints, 3u);
  EXPECT_DOUBLE_EQ(stats.longest, 7);
  EXPECT_DOUBLE_EQ(stats.shortest, 0);
  EXPECT_DOUBLE_EQ(stats.meanLength, 7.0 / 4);
  EXPECT_DOUBLE_EQ(stats.least, 0.5);
  EXPECT_DOUBLE_EQ(stats.greatest, 3);
  EXPECT_EQ(stats.box.hi, Vec3(5, 5, 5));
  EXPECT_EQ(strandStats(StrandSet{}).strands, 0u);
}

TEST(StrandStats, FindsPointsInsideASurface) {
  const Surface ball(dome(2, Vec3::Zero()));
  StrandSet set;
  set.offsets = {0, 5};
  set.points = {{0, 0, 0}, {0, 0.5, 0}, {0, 1, 0}, {0, 3, 0}, {0, 5, 0}};
  EXPECT_DOUBLE_EQ(insideFraction(set, ball), 0.5);  // the root does not count
  EXPECT_DOUBLE_EQ(insideFraction(set, ball, 0), 0.6);
  EXPECT_DOUBLE_EQ(insideFraction(StrandSet{}, ball), 0);
}

}  // namespace
}  // namespace coif
