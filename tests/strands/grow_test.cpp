#include "coif/strands/grow.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstring>
#include <map>
#include <set>

#include "coif/strands/roots.h"
#include "coif/strands/sampler.h"
#include "sample_meshes.h"

namespace coif {
namespace {

GrowResult grown(const HairMesh& mesh, const GrowOptions& options, int threads = 0) {
  Context context;
  context.threads = threads;
  auto result = grow(mesh, options, context);
  EXPECT_TRUE(result.ok()) << (result.ok() ? "" : result.error().text());
  return result.ok() ? std::move(result).value() : GrowResult{};
}

template <class T>
bool sameBytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool sameBytes(const StrandSet& a, const StrandSet& b) {
  return sameBytes(a.offsets, b.offsets) && sameBytes(a.points, b.points) && sameBytes(a.widths, b.widths) &&
         sameBytes(a.ids, b.ids) && sameBytes(a.rootFaces, b.rootFaces) &&
         sameBytes(a.weightOffsets, b.weightOffsets) && sameBytes(a.weights, b.weights) &&
         sameBytes(a.rootUvs, b.rootUvs) && sameBytes(a.groups, b.groups);
}

/// Control points of strand s in double, from the weights that the set carries.
std::vector<Vec3> controlPoints(const HairMesh& mesh, const StrandSet& strands, std::size_t s) {
  const Bundle& bundle = mesh.bundles()[mesh.indexOf(BundleId(strands.rootFaces[s]))];
  std::vector<Vec3> out(bundle.height() + 1, Vec3::Zero());
  for (std::uint32_t k = 0; k <= bundle.height(); ++k) {
    for (std::uint32_t i = 0; i < bundle.corners; ++i) {
      out[k] += double(strands.weights[strands.weightOffsets[s] + i]) * mesh.position(bundle.face(k)[i]);
    }
  }
  return out;
}

TEST(Grow, MakesExactlyTheCountWithEveryField) {
  HairMesh mesh = samples::grid(5, 4, 3, 0.2);
  mesh.setGroup(3, mesh.addGroup("fringe"));
  for (const std::size_t count : {0, 1, 7, 20, 999, 5000}) {
    GrowOptions options;
    options.count = count;
    options.points = 9;
    const StrandSet strands = grown(mesh, options).strands;
    ASSERT_TRUE(validate(strands).ok()) << validate(strands).error().text();
    EXPECT_EQ(strands.strandCount(), count);
    EXPECT_EQ(strands.pointCount(), 9 * count);
    EXPECT_EQ(strands.widths.size(), 9 * count);
    EXPECT_EQ(strands.weights.size(), 4 * count);
    EXPECT_EQ(strands.groupNames.size(), 2u);
    EXPECT_EQ(std::set(strands.ids.begin(), strands.ids.end()).size(), count);
    for (std::size_t s = 0; s < count; ++s) {
      EXPECT_EQ(std::uint32_t(bundleOf(strands.ids[s])), strands.rootFaces[s]);
      EXPECT_EQ(strands.groups[s], mesh.indexOf(BundleId(strands.rootFaces[s])) == 3 ? 1u : 0u);
    }
  }
}

// Points in float from columns in float: three roundings of coordinates below 8, 1e-6 each.
TEST(Grow, PointsLieOnTheSplineThroughTheControlPoints) {
  const HairMesh mesh = samples::grid(3, 3, 5, 0.3);
  for (const Knots knots : {Knots::Uniform, Knots::Centripetal, Knots::Chordal}) {
    GrowOptions options;
    options.count = 50;
    options.points = 21;
    options.knots = knots;
    const StrandSet strands = grown(mesh, options).strands;
    for (std::size_t s = 0; s < strands.strandCount(); ++s) {
      const std::vector<Vec3> control = controlPoints(mesh, strands, s);
      for (std::size_t p = 0; p < 21; p += 4) {  // 20 pieces over 5 segments: every fourth is a control point
        EXPECT_LE((strands.strand(s)[p].cast<double>() - control[p / 4]).norm(), 3e-6);
      }
      if (knots != Knots::Uniform) continue;
      const std::vector<Vec3> curve = catmullRom(control, 21);
      for (std::size_t p = 0; p < 21; ++p) {
        EXPECT_LE((strands.strand(s)[p].cast<double>() - curve[p]).norm(), 3e-6);
      }
    }
  }
}

TEST(Grow, IsTheSameForAnyNumberOfThreads) {
  const HairMesh mesh = samples::grid(7, 5, 4, 0.3);
  for (const bool adaptive : {false, true}) {
    GrowOptions options;
    options.count = 4321;
    if (adaptive) options.tolerance = 1e-3;
    const StrandSet one = grown(mesh, options, 1).strands;
    for (const int threads : {2, 3, 8}) EXPECT_TRUE(sameBytes(one, grown(mesh, options, threads).strands));
  }
}

TEST(Grow, FewerStrandsAreAPrefixOfMore) {
  const HairMesh mesh = samples::grid(6, 6, 3, 0.2);
  GrowOptions options;
  options.count = 3000;
  const StrandSet all = grown(mesh, options).strands;
  for (const std::size_t count : {1, 10, 36, 500, 2999}) {
    options.count = count;
    const StrandSet few = grown(mesh, options).strands;
    EXPECT_TRUE(std::equal(few.ids.begin(), few.ids.end(), all.ids.begin()));
    EXPECT_EQ(0, std::memcmp(few.points.data(), all.points.data(), few.points.size() * sizeof(Vec3f)));
    EXPECT_EQ(0, std::memcmp(few.weights.data(), all.weights.data(), few.weights.size() * sizeof(float)));
  }
}

/// Root weights by id: a kept strand keeps its name and its place.
std::map<std::uint64_t, std::vector<float>> placesById(const StrandSet& strands) {
  std::map<std::uint64_t, std::vector<float>> out;
  for (std::size_t s = 0; s < strands.strandCount(); ++s) {
    out[strands.ids[s]] = {strands.weights.begin() + std::ptrdiff_t(strands.weightOffsets[s]),
                           strands.weights.begin() + std::ptrdiff_t(strands.weightOffsets[s + 1])};
  }
  return out;
}

TEST(Grow, DensityAndEditsElsewhereKeepIdsAndPlaces) {
  HairMesh mesh = samples::grid(6, 6, 3, 0.2);
  GrowOptions options;
  options.count = 2000;
  const auto before = placesById(grown(mesh, options).strands);

  std::vector<double> density(mesh.bundles().size(), 1.0);
  for (std::size_t b = 0; b < density.size(); b += 2) density[b] = 3;
  density[5] = 0;
  options.density = density;
  const StrandSet dense = grown(mesh, options).strands;
  EXPECT_EQ(dense.strandCount(), 2000u);
  for (const std::uint32_t bundle : dense.rootFaces) EXPECT_NE(mesh.indexOf(BundleId(bundle)), 5u);

  options.density = {};
  ASSERT_TRUE(deleteFaces(mesh, std::vector<BundleId>{mesh.bundles()[0].id}).ok());
  ASSERT_TRUE(extrudeFaces(mesh, std::vector<BundleId>{mesh.bundles()[35].id}, {.distance = 1}).ok());
  const StrandSet edited = grown(mesh, options).strands;

  for (const StrandSet* after : {&dense, &edited}) {
    std::size_t kept = 0;
    for (const auto& [id, weights] : placesById(*after)) {
      const auto was = before.find(id);
      if (was == before.end()) continue;
      EXPECT_EQ(was->second, weights) << "strand " << id;
      ++kept;
    }
    EXPECT_GT(kept, 1000u);
  }
}

// A similarity maps roots to roots. Coordinates grow to 50, so floats carry 4e-6; the planes' axes turn by
// 1e-16.
TEST(Grow, FollowsASimilarityOfTheMesh) {
  HairMesh mesh = samples::grid(4, 4, 3, 0.3);
  GrowOptions options;
  options.count = 400;
  const StrandSet before = grown(mesh, options).strands;
  const Mat3 turn = 2.5 * Eigen::AngleAxisd(0.7, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
    mesh.setPosition(v, turn * mesh.position(v) + Vec3(10, 20, -30));
  }
  const StrandSet after = grown(mesh, options).strands;
  ASSERT_EQ(before.ids, after.ids);
  for (std::size_t p = 0; p < before.pointCount(); ++p) {
    EXPECT_LE(
        (turn * before.points[p].cast<double>() + Vec3(10, 20, -30) - after.points[p].cast<double>()).norm(),
        3e-5);
  }
}

// Evaluation is affine: sampling the moved mesh with the same roots equals moving the samples, for uniform
// knots.
TEST(Grow, SamplingCommutesWithAnyAffineMap) {
  const HairMesh mesh = samples::grid(4, 4, 3, 0.3);
  HairMesh moved = mesh;
  Mat3 map;
  map << 2, 0.5, 0, -0.3, 1, 0.8, 0, 0.1, 3;
  for (std::uint32_t v = 0; v < moved.vertices().size(); ++v)
    moved.setPosition(v, map * mesh.position(v) + Vec3(1, 2, 3));
  const RootSet roots = placeRoots(mesh, {.count = 300}).value();
  const StrandSampler a(mesh, roots, {}), b(moved, roots, {});
  std::vector<Vec3f> pointsA(a.pointCount()), pointsB(b.pointCount());
  a.evaluate(pointsA);
  b.evaluate(pointsB);
  for (std::size_t p = 0; p < pointsA.size(); ++p) {
    EXPECT_LE((map * pointsA[p].cast<double>() + Vec3(1, 2, 3) - pointsB[p].cast<double>()).norm(), 1e-5);
  }
}

TEST(Grow, WidthsGoLinearlyFromRootToTip) {
  const HairMesh mesh = samples::grid(2, 2, 3);
  GrowOptions options;
  options.count = 10;
  options.points = 5;
  options.width = 0.2;
  options.tipWidth = 0.5;
  const StrandSet strands = grown(mesh, options).strands;
  for (std::size_t s = 0; s < 10; ++s) {
    for (std::size_t p = 0; p < 5; ++p)
      EXPECT_NEAR(strands.widths[5 * s + p], 0.2 - 0.1 * double(p) / 4, 1e-7);
  }
  options.width = 0;
  options.metersPerUnit = 0.01;  // centimetres: 0.08 mm is 0.008
  EXPECT_FLOAT_EQ(grown(mesh, options).strands.widths[0], 0.008f);
}

void expectRefused(const HairMesh& mesh, const GrowOptions& options, ErrorCode code) {
  const auto result = grow(mesh, options);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, code) << result.error().text();
}

TEST(Grow, RefusesBadInput) {
  const HairMesh mesh = samples::grid(2, 2, 2);
  const std::vector<double> negative(4, -1.0), few(3, 1.0), none(4, 0.0);
  expectRefused(mesh, {.points = 1}, ErrorCode::InvalidArgument);
  expectRefused(mesh, {.tolerance = 0.0}, ErrorCode::InvalidArgument);
  expectRefused(mesh, {.tolerance = std::nan("")}, ErrorCode::InvalidArgument);
  expectRefused(mesh, {.width = -1}, ErrorCode::InvalidArgument);
  expectRefused(mesh, {.tipWidth = std::nan("")}, ErrorCode::InvalidArgument);
  expectRefused(mesh, {.metersPerUnit = 0}, ErrorCode::InvalidArgument);
  expectRefused(mesh, {.density = negative}, ErrorCode::InvalidArgument);
  expectRefused(mesh, {.density = few}, ErrorCode::InvalidArgument);
  expectRefused(mesh, {.density = none}, ErrorCode::Degenerate);
  expectRefused(mesh, {.count = std::size_t{1} << 33}, ErrorCode::TooLarge);
  expectRefused(mesh, {.count = std::size_t{1} << 31, .points = 65536}, ErrorCode::TooLarge);  // 2 PiB: said at once
  expectRefused(samples::gridRoot(2, 2), {}, ErrorCode::Degenerate);
  expectRefused(HairMesh{}, {}, ErrorCode::Degenerate);
  EXPECT_EQ(grown(HairMesh{}, {.count = 0}).strands.strandCount(), 0u);
  std::atomic<bool> cancel{true};
  Context context;
  context.cancel = &cancel;
  EXPECT_EQ(grow(mesh, {}, context).error().code, ErrorCode::Cancelled);
}

TEST(Grow, ReportsWhatItLeftOut) {
  HairMesh mesh = samples::grid(3, 3, 2);
  ASSERT_TRUE(deleteFaces(mesh, std::vector<BundleId>{mesh.bundles()[4].id}).ok());
  ASSERT_TRUE(deleteFaces(mesh, std::vector<BundleId>{mesh.bundles()[4].id}).ok());  // height 0
  for (std::uint32_t k = 1; k <= 2; ++k) {                                           // no length
    const Bundle& flat = mesh.bundles()[0];
    for (std::uint32_t i = 0; i < 4; ++i) mesh.setPosition(flat.face(k)[i], mesh.position(flat.face(0)[i]));
  }
  const GrowResult result = grown(mesh, {.count = 700});
  EXPECT_EQ(result.strands.strandCount(), 700u);
  EXPECT_EQ(result.report.barrenBundles, 1u);
  EXPECT_EQ(result.report.zeroLength, 100u);  // one of seven live faces' share
  EXPECT_EQ(std::count(result.strands.rootFaces.begin(), result.strands.rootFaces.end(),
                       std::uint32_t(mesh.bundles()[0].id)),
            0);
}

}  // namespace
}  // namespace coif
