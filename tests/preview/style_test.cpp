// Styled strands made on the GPU against StylePlan::apply, and what of them goes there when.
#include <algorithm>
#include <cmath>

#include "coif/base/random.h"
#include "coif/light/image_metrics.h"
#include "coif/preview/session.h"
#include "coif/scalp/example_head.h"
#include "preview/detail.h"
#include "preview_fixture.h"
#include "sample_hair.h"
#include "strands_made.h"
#include "style/style_samples.h"

namespace coif {
namespace {

using testing::boxSize, testing::kAgreement, testing::worstDifference;

class Styled : public testing::PreviewTest {
 protected:
  static StrandSet grown(const HairMesh& mesh, std::size_t count, std::uint32_t points, Knots knots) {
    GrowOptions options;
    options.count = count, options.points = points, options.knots = knots;
    options.width = 0.01, options.tipWidth = 0.004;
    return grow(mesh, options).value().strands;
  }
  /// The mesh with every vertex above the root layer somewhere near.
  static HairMesh bent(HairMesh mesh, double by) {
    for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
      const CounterRandom random(9, v);
      if (mesh.vertices()[v].layer > 0)
        mesh.setPosition(
            v, mesh.position(v) + by * Vec3(random.uniform(0), random.uniform(1) - 1, random.uniform(2)));
    }
    return mesh;
  }
  static std::vector<Vec3> positionsOf(const HairMesh& mesh) {
    std::vector<Vec3> positions;
    for (const HairVertex& v : mesh.vertices()) positions.push_back(v.position);
    return positions;
  }
  static StrandSet applied(const StylePlan& plan, const HairMesh& mesh, StrandSet strands) {
    EXPECT_TRUE(plan.apply(mesh, strands).ok());
    return strands;
  }
};

/// Operators of every kind, each so that it does something on a lawn of hair ten units high.
StyleStack everyKindOnLawn() {
  StyleStack stack;
  for (const StyleKind& kind : styleKinds()) {
    StyleOperator op = makeStyleOperator(kind.name).value();
    if (kind.name == "cut_plane") op.parameters = {{"point_y", 6}, {"normal_y", 1}};
    stack.push_back(op);
  }
  return stack;
}

TEST_F(Styled, AgreesForEveryKindWhereItStandsAndWhereItMoves) {
  const HairMesh mesh = bent(samples::lawn(3, 10, 5), 0.8), there = bent(mesh, 1.2);
  const StrandSet straight = grown(mesh, 400, 33, Knots::Chordal),
                  moved = grown(there, 400, 33, Knots::Chordal);
  const Surface head(makeExampleHead());
  StyleOptions options;
  options.head = &head;
  PreviewSession session(*preview());
  ASSERT_TRUE(session.setHair(mesh, straight, Knots::Chordal).ok());
  int acted = 0;
  for (const StyleOperator& each : everyKindOnLawn()) {
    const StylePlan plan = StylePlan::create(mesh, straight, std::span(&each, 1), options).value();
    if (plan.changesNothing()) continue;
    ++acted;
    ASSERT_TRUE(session.setStyle(plan.view()).ok()) << each.kind;
    ASSERT_TRUE(session.moveHair(positionsOf(mesh)).ok());
    const StrandSet here = applied(plan, mesh, straight), follows = applied(plan, there, moved);
    const double still = worstDifference(session, mesh, here) / boxSize(here);
    EXPECT_LT(still, kAgreement) << each.kind;
    ASSERT_TRUE(session.moveHair(positionsOf(there)).ok());
    const double after = worstDifference(session, there, follows) / boxSize(follows);
    EXPECT_LT(after, kAgreement) << each.kind;
    RecordProperty(each.kind, std::to_string(still) + " " + std::to_string(after));
  }
  EXPECT_EQ(acted, int(styleKinds().size()));
}

TEST_F(Styled, AgreesForAStackOnPolygonsSplitLayersAndLongerHair) {
  const HairMesh mesh = samples::splitPolygons(), there = bent(mesh, 0.2);
  StyleStack stack{samples::op("clump"), samples::op("curl"), samples::op("length"), samples::op("width"),
                   samples::op("frizz")};
  for (const double factor : {0.4, 1.6}) {
    stack[2].amount = 1, stack[2].parameters = {{"scale", factor}, {"variation", 0.3}};
    for (const std::uint32_t points : {2u, 3u, 64u}) {
      const StrandSet straight = grown(mesh, 300, points, Knots::Centripetal);
      const StylePlan plan = StylePlan::create(mesh, straight, stack).value();
      ASSERT_FALSE(plan.changesNothing());
      PreviewSession session(*preview());
      ASSERT_TRUE(session.setHair(mesh, straight, Knots::Centripetal).ok());
      ASSERT_TRUE(session.setStyle(plan.view()).ok());
      const StrandSet here = applied(plan, mesh, straight);
      EXPECT_LT(worstDifference(session, mesh, here), kAgreement * boxSize(here)) << factor << " " << points;
      ASSERT_TRUE(session.moveHair(positionsOf(there)).ok());
      const StrandSet follows = applied(plan, there, grown(there, 300, points, Knots::Centripetal));
      EXPECT_LT(worstDifference(session, there, follows), kAgreement * boxSize(follows))
          << factor << " " << points;
    }
  }
}

TEST_F(Styled, AgreesOnAHeadWhereRootsAreLifted) {
  const PolygonMesh head = makeExampleHead();
  const samples::HeadHair hair = samples::headHair("bob", head);
  const double size = bounds(head.positions).diagonal();
  const StrandSet straight =
      samples::grownOn(hair.mesh, 1000, Knots::Uniform, hair.surface.get(), 1e-4 * size);
  const StyleStack stack{samples::op("clump"), samples::op("curl"), samples::op("trim")};
  const StylePlan plan = StylePlan::create(hair.mesh, straight, stack).value();
  PreviewSession session(*preview());
  ASSERT_TRUE(session.setHair(hair.mesh, straight).ok());
  ASSERT_TRUE(session.setStyle(plan.view()).ok());
  const StrandSet here = applied(plan, hair.mesh, straight);
  EXPECT_LT(worstDifference(session, hair.mesh, here), kAgreement * boxSize(here));
}

TEST_F(Styled, APlanIsUploadedOnceAndAMoveUploadsTheMeshAlone) {
  const HairMesh mesh = samples::lawn(3, 10);
  const StrandSet straight = grown(mesh, 2000, 33, Knots::Uniform);
  const StyleStack curls{samples::op("curl")}, locks{samples::op("clump")};
  const StylePlan curl = StylePlan::create(mesh, straight, curls).value();
  PreviewSession session(*preview());
  session.setCamera(frameBox({Vec3(-1, 0, -4), Vec3(4, 10, 1)}, UpAxis::Y, 20, 10));
  // Two points a strand do for the roots; the style has its own number.
  ASSERT_TRUE(session.setHair(mesh, grown(mesh, 2000, 2, Knots::Uniform)).ok());
  const PreviewOptions options = small(96);
  const Picture plain = render(session, options);
  EXPECT_EQ(plain.uploaded.style, 0u);
  ASSERT_TRUE(session.setStyle(curl.view()).ok());
  const Picture curled = render(session, options);
  EXPECT_EQ(curled.uploaded.strands, 0u);
  EXPECT_EQ(curled.uploaded.style, 16u * (2000 * 33 + mesh.bundles().size()));
  EXPECT_NE(curled.image.rgba, plain.image.rgba);
  ASSERT_TRUE(session.moveHair(positionsOf(bent(mesh, 0.5))).ok());
  const Picture moved = render(session, options);
  EXPECT_EQ(moved.uploaded.strands + moved.uploaded.style + moved.uploaded.head, 0u);
  EXPECT_EQ(moved.uploaded.hairMesh, 16 * mesh.vertices().size());
  EXPECT_NE(moved.image.rgba, curled.image.rgba);
  ASSERT_TRUE(session.moveHair(positionsOf(mesh)).ok());
  EXPECT_EQ(render(session, options).image.rgba, curled.image.rgba) << "there and back";
  // Another plan takes its place; none brings back the first picture.
  ASSERT_TRUE(session.setStyle(StylePlan::create(mesh, straight, locks).value().view()).ok());
  const Picture gathered = render(session, options);
  EXPECT_GT(gathered.uploaded.style, 0u);
  EXPECT_NE(gathered.image.rgba, curled.image.rgba);
  ASSERT_TRUE(session.setStyle({}).ok());
  EXPECT_EQ(render(session, options).image.rgba, plain.image.rgba);
}

TEST_F(Styled, AtTheAutomaticDetailItIsThePictureOfTheSameStrandsAsPoints) {
  const HairMesh mesh = samples::lawn(4, 10);
  const StrandSet straight = grown(mesh, 3000, 97, Knots::Uniform);
  const StyleStack stack{samples::op("curl", {{"radius", 0.5}, {"wavelength", 1.2}})};
  const StylePlan plan = StylePlan::create(mesh, straight, stack).value();
  const StrandSet curls = applied(plan, mesh, straight);
  const Camera camera = frameBox({Vec3(-1, 0, -5), Vec3(5, 10, 1)}, UpAxis::Y, 20, 10);
  PreviewSession onMesh(*preview()), asPoints(*preview());
  ASSERT_TRUE(onMesh.setHair(mesh, straight).ok() && onMesh.setStyle(plan.view()).ok());
  ASSERT_TRUE(asPoints.setStrands(curls).ok());
  onMesh.setCamera(camera), asPoints.setCamera(camera);
  PreviewOptions options = small(160);
  options.transparentBackground = false;
  const Picture a = render(onMesh, options), b = render(asPoints, options);
  // A turn of a helix wants at least six points to stay one: eight turns.
  EXPECT_GE(double(a.segmentsDrawn), 6 * 8 * double(a.strandsDrawn));
  EXPECT_EQ(a.segmentsDrawn, b.segmentsDrawn);
  // The same strands, lit through fogs of other coarse strands: of 13 points here, of 17 there (0.010 apart;
  // 0.018 before coarse strands were given the length of their curls).
  options.lod = false;
  const Picture all = render(asPoints, options);
  const double own = flip(toLinear(a.image), toLinear(all.image))->mean;
  const double other = flip(toLinear(b.image), toLinear(all.image))->mean;
  EXPECT_LT(own, other + 0.015) << own << " and " << other << ", " << a.segmentsDrawn << " and "
                                << b.segmentsDrawn;
  RecordProperty("flip", std::to_string(own) + " as points " + std::to_string(other));
}

TEST_F(Styled, WhatCannotBeLaidOnIsRefusedAndLeavesThePlainHair) {
  const HairMesh mesh = samples::lawn(3, 10);
  const StrandSet straight = grown(mesh, 300, 17, Knots::Uniform),
                  fewer = grown(mesh, 200, 17, Knots::Uniform);
  const StyleStack stack{samples::op("curl")};
  const StylePlan plan = StylePlan::create(mesh, straight, stack).value();
  PreviewSession session(*preview());
  EXPECT_EQ(session.setStyle(plan.view()).error().code, ErrorCode::InvalidArgument) << "no hair";
  ASSERT_TRUE(session.setStrands(straight).ok());
  EXPECT_EQ(session.setStyle(plan.view()).error().code, ErrorCode::InvalidArgument) << "points";
  ASSERT_TRUE(session.setHair(mesh, fewer).ok());
  session.setCamera(frameBox({Vec3(-1, 0, -4), Vec3(4, 10, 1)}, UpAxis::Y, 20, 10));
  const Image plain = render(session, small(64)).image;
  EXPECT_EQ(session.setStyle(plan.view()).error().code, ErrorCode::InvalidArgument) << "other strands";
  EXPECT_EQ(render(session, small(64)).image.rgba, plain.rgba);
  // Strands of different numbers of points, though as many in all.
  const StylePlan own = StylePlan::create(mesh, fewer, stack).value();
  StrandStyle uneven = own.view();
  std::vector<std::uint64_t> offsets(uneven.strandOffsets.begin(), uneven.strandOffsets.end());
  ++offsets[1];
  uneven.strandOffsets = offsets;
  const Status refused = session.setStyle(uneven);
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.error().message.find("equally many points"), std::string::npos);
  EXPECT_EQ(render(session, small(64)).image.rgba, plain.rgba);
  ASSERT_TRUE(session.setStyle(own.view()).ok());
}

TEST(StyleOnTheGpu, OfMoreStrandsThanFitAPrefixIsDrawnWider) {
  const HairMesh mesh = samples::lawn(3, 10);
  const StrandSet straight = samples::strandsOn(mesh, 500, 17);
  const StyleStack stack{samples::op("curl")};
  const StylePlan plan = StylePlan::create(mesh, straight, stack).value();
  preview::PreparedHair hair = preview::prepareGrown(mesh, straight, Knots::Uniform, {}).value();
  const std::size_t room = mesh.bundles().size() + 17 * 123 + 5;
  const auto kept = preview::prepareStyle(hair.model, plan.view(), room, {}).value();
  EXPECT_EQ(kept.size(), mesh.bundles().size() + 17 * 123);
  preview::DetailOptions options;
  for (const bool lod : {false, true}) {
    options.lod = lod;
    const auto drawn = preview::makePlan(hair.model, options, [](const Vec3&) { return 1e-3; }, {});
    EXPECT_EQ(drawn.strands, 123u);
    EXPECT_NEAR(drawn.widthScale, 500.0 / 123.0, 1e-12);
  }
  // The first of them in progressive order, bundle by bundle, each with its own offsets.
  std::size_t at = 0;
  for (std::size_t l = 0; l < hair.model.locks.size(); ++l) {
    EXPECT_EQ(kept[l].x(), float(at));
    for (const std::uint32_t rank : hair.model.members[l].ranks) {
      if (rank >= 123) continue;
      const auto* own = kept.data() + mesh.bundles().size() + 17 * at++;
      EXPECT_EQ(own[0].x(), plan.view().reach[rank]);
      EXPECT_EQ(own[16].head<3>(), plan.view().offsets[17 * rank + 16]);
    }
  }
  EXPECT_EQ(at, 123u);
}

}  // namespace
}  // namespace coif
