#include "coif/simulate/chain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "coif/hairmesh/operations.h"
#include "strands/sample_meshes.h"

namespace coif {
namespace {

// The frame product and the normalisation round a few times each.
constexpr double kRounding = 1e-14;

TEST(Chains, AreTheHairMeshesEdges) {
  const HairMesh mesh = samples::grid(2, 1, 4, 0.1);
  const ChainBuild build = chainsFromMesh(mesh, {.linearDensity = 3, .lateral = 5}).value();
  const ChainSet& c = build.chains;
  EXPECT_EQ(c.treeCount(), 6u);
  EXPECT_EQ(c.linkCount(), 24u);
  EXPECT_EQ(build.report.branches, 0u);
  double mass = 0, length = 0;
  for (std::uint32_t i = 0; i < c.nodeCount(); ++i) {
    EXPECT_EQ(build.nodeOf[c.sources[i]], i);
    EXPECT_EQ(c.restPositions[i], mesh.position(c.sources[i]));
    mass += c.masses[i];
    if (c.parents[i] == kNone) continue;
    EXPECT_EQ(c.sources[c.parents[i]], mesh.vertices()[c.sources[i]].parent);
    length += c.lengths[i];
  }
  EXPECT_NEAR(mass, 3 * length, kRounding * mass);
  EXPECT_EQ(c.laterals.size(), 28u);  // seven root edges, four layers
}

TEST(Chains, RestDirectionsRebuildTheRestShape) {
  const HairMesh mesh = samples::grid(1, 1, 7, 0.4);
  const ChainSet c = chainsFromMesh(mesh).value().chains;
  std::vector<Mat3> frames(c.nodeCount());
  linkFrames(c, c.restPositions, c.rootFrames, frames);
  for (std::uint32_t i = 0; i < c.nodeCount(); ++i) {
    if (c.parents[i] == kNone) continue;
    const Vec3 link = c.lengths[i] * (frames[c.parents[i]] * c.restDirections[i]);
    EXPECT_LE((c.restPositions[c.parents[i]] + link - c.restPositions[i]).norm(), kRounding * 10);
  }
}

TEST(Chains, SplitLayersMakeTrees) {
  HairMesh mesh = samples::grid(2, 1, 3);
  // A vertex of layer 2 that two bundles share: from there on each has its own.
  for (const HairVertex& v : mesh.vertices()) {
    if (v.layer == 2 && separateVertex(mesh, v.id).ok()) break;
  }
  const ChainBuild build = chainsFromMesh(mesh).value();
  EXPECT_EQ(build.report.branches, 2u);  // the whole edge between the bundles came apart
  EXPECT_EQ(build.chains.treeCount(), 6u);
  EXPECT_EQ(build.chains.linkCount(), 22u);  // 18 of the plain columns, two more a branch
  EXPECT_TRUE(validate(build.chains).ok());
}

TEST(Chains, CoincidentNodesAreWelded) {
  const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {2, 0, 0}, {5, 5, 5}, {5, 5, 5}};
  const std::vector<std::uint64_t> offsets{0, 4, 6};
  const ChainBuild build = chainsFromCurves(points, offsets).value();
  EXPECT_EQ(build.chains.treeCount(), 1u);
  EXPECT_EQ(build.chains.linkCount(), 2u);
  EXPECT_EQ(build.report.weldedNodes, 2u);
  EXPECT_EQ(build.report.droppedTrees, 1u);
  EXPECT_EQ(build.nodeOf[2], build.nodeOf[1]);
  EXPECT_EQ(build.nodeOf[5], kNone);
  EXPECT_EQ(build.report.notes.size(), 2u);
}

TEST(Chains, BadInputIsRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::uint64_t> offsets{0, 2};
  const std::vector<Vec3> good{{0, 0, 0}, {1, 0, 0}}, bad{{0, 0, 0}, {1, nan, 0}};
  EXPECT_EQ(chainsFromCurves(bad, offsets).error().code, ErrorCode::Degenerate);
  EXPECT_FALSE(chainsFromCurves(good, std::vector<std::uint64_t>{0, 1}).ok());
  EXPECT_FALSE(chainsFromCurves(good, offsets, {.linearDensity = 0}).ok());
  EXPECT_FALSE(chainsFromCurves(good, offsets, {.droop = -1.0}).ok());
  ChainSet c = chainsFromCurves(good, offsets).value().chains;
  c.lengths[1] = 0;
  EXPECT_EQ(validate(c).error().place, "node 1");
  c.lengths[1] = 1, c.masses[1] = nan;
  EXPECT_FALSE(validate(c).ok());
}

// A round fibre: 70 µm across, 4 GPa, the figure worked by hand.
TEST(Chains, FibreRigidityIsThatOfARoundBeam) {
  EXPECT_NEAR(fibreRigidity(4e9, 35e-6), 4e9 * 3.14159265358979 * 35e-6 * 35e-6 * 35e-6 * 35e-6 / 4, 1e-22);
}

}  // namespace
}  // namespace coif
