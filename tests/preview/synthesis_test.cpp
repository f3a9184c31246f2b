// Strands made on the GPU against StrandSampler, and the level of detail that decides which.
#include <algorithm>
#include <cmath>

#include "coif/base/random.h"
#include "coif/io/mesh_io.h"
#include "coif/preview/session.h"
#include "coif/scalp/example_head.h"
#include "preview_fixture.h"
#include "sample_hair.h"

namespace coif {
namespace {

using Synthesis = testing::PreviewTest;

double boxSize(const StrandSet& strands) {
  Vec3f lo = strands.points[0], hi = lo;
  for (const Vec3f& p : strands.points) lo = lo.cwiseMin(p), hi = hi.cwiseMax(p);
  return double((hi - lo).norm());
}

/// Greatest distance between the strands of the picture at full detail and those of `truth`, matched by lock.
double worstDifference(PreviewSession& session, const HairMesh& mesh, const StrandSet& truth) {
  PreviewOptions options;
  options.width = options.height = 32;
  options.subframes = 1;
  options.shadows = options.lod = false;
  Camera camera = frameBox({Vec3::Constant(-3), Vec3::Constant(3)}, UpAxis::Y, 0, 0);
  session.setCamera(camera);
  const auto picture = session.render(options);
  EXPECT_TRUE(picture.ok()) << (picture.ok() ? "" : picture.error().text());
  if (!picture.ok()) return INFINITY;
  const StrandSet made = session.readBack().value();
  EXPECT_EQ(made.pointCount(), truth.pointCount());
  std::vector<std::size_t> order(truth.strandCount());
  for (std::size_t s = 0; s < order.size(); ++s) order[s] = s;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return mesh.indexOf(BundleId(truth.rootFaces[a])) < mesh.indexOf(BundleId(truth.rootFaces[b]));
  });
  double worst = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const auto expected = truth.strand(order[i]), strand = made.strand(i);
    if (expected.size() != strand.size()) return INFINITY;
    for (std::size_t p = 0; p < expected.size(); ++p) {
      worst = std::max(worst, double((expected[p] - strand[p]).norm()));
      const float width = truth.widths[truth.offsets[order[i]] + p];
      EXPECT_NEAR(made.widths[made.offsets[i] + p], width,
                  1e-6f * width + 1e-9f);  // a few units of the last place
    }
  }
  return worst;
}

// The bar, 1e-5 of the bounding box. The sums are float of numbers as large as the box: some 1e-6.
constexpr double kAgreement = 1e-5;

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
