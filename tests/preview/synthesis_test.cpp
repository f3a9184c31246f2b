// Strands made on the GPU against StrandSampler, and the level of detail that decides which.
#include <algorithm>
#include <cmath>

#include "coif/base/random.h"
#include "coif/io/mesh_io.h"
#include "coif/preview/session.h"
#include "coif/scalp/example_head.h"
#include "preview_fixture.h"
#include "sample_hair.h"
#include "strands_made.h"

namespace coif {
namespace {

using Synthesis = testing::PreviewTest;
using testing::boxSize, testing::kAgreement, testing::worstDifference;

TEST_F(Synthesis, AgreesWithTheSamplerForEveryKindOfKnots) {
  const HairMesh mesh = samples::grid(4, 3, 6, 0.35);
  for (const Knots knots : {Knots::Uniform, Knots::Centripetal, Knots::Chordal}) {
    const StrandSet strands = samples::grownOn(mesh, 700, knots);
    PreviewSession session(*preview());
    ASSERT_TRUE(session.setHair(mesh, strands, knots).ok());
    const double worst = worstDifference(session, mesh, strands) / boxSize(strands);
    EXPECT_LT(worst, kAgreement);
    RecordProperty("worst" + std::to_string(int(knots)), std::to_string(worst));
  }
}

TEST_F(Synthesis, AgreesOnSplitLayersAndPolygonsOfManyCorners) {
  const HairMesh mesh = samples::splitPolygons();
  ASSERT_FALSE(mesh.splits().empty());
  const StrandSet strands = samples::grownOn(mesh, 500, Knots::Centripetal);
  PreviewSession session(*preview());
  ASSERT_TRUE(session.setHair(mesh, strands, Knots::Centripetal).ok());
  EXPECT_LT(worstDifference(session, mesh, strands), kAgreement * boxSize(strands));
}

TEST_F(Synthesis, AgreesAfterTheMeshMovedAndUploadsTheMeshAlone) {
  HairMesh mesh = samples::grid(4, 3, 6, 0.35);
  const StrandSet strands = samples::grownOn(mesh, 900, Knots::Chordal);
  PreviewSession session(*preview());
  ASSERT_TRUE(session.setHair(mesh, strands, Knots::Chordal).ok());
  EXPECT_LT(worstDifference(session, mesh, strands), kAgreement * boxSize(strands));
  std::vector<Vec3> positions;
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
    const CounterRandom random(9, v);
    Vec3 p = mesh.position(v);
    if (mesh.vertices()[v].layer > 0)
      p += 0.3 * Vec3(random.uniform(0), random.uniform(1), random.uniform(2));
    mesh.setPosition(v, p);
    positions.push_back(p);
  }
  ASSERT_TRUE(session.moveHair(positions).ok());
  const StrandSet moved =
      samples::grownOn(mesh, 900, Knots::Chordal);  // the root layer stayed: the same roots
  EXPECT_LT(worstDifference(session, mesh, moved), kAgreement * boxSize(moved));
}

TEST_F(Synthesis, AgreesOnHeadsWhereRootsAreLifted) {
  std::vector<PolygonMesh> heads{makeExampleHead()};
  const auto scan = loadPolygonMesh(std::string(COIF_SHARED_DATA) + "/heads/lee-perry-smith.obj");
  if (scan.ok()) heads.push_back(*scan);
  for (const PolygonMesh& head : heads) {
    const samples::HeadHair hair = samples::headHair("bob", head);
    ASSERT_FALSE(hair.mesh.splits().empty()) << "a bob is parted";
    const double size = bounds(head.positions).diagonal();
    const StrandSet strands =
        samples::grownOn(hair.mesh, 1500, Knots::Uniform, hair.surface.get(), 1e-4 * size);
    PreviewSession session(*preview());
    ASSERT_TRUE(session.setHair(hair.mesh, strands).ok());
    EXPECT_LT(worstDifference(session, hair.mesh, strands), kAgreement * boxSize(strands));
  }
}

}  // namespace
}  // namespace coif
