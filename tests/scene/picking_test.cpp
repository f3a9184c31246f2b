#include "coif/scene/picking.h"

#include <gtest/gtest.h>

#include <cmath>

#include "coif/scene/navigation.h"
#include "scene/sample_scene.h"

namespace coif {
namespace {

Camera above() {
  Camera camera;
  camera.eye = Vec3(1, 1, 20);
  camera.target = Vec3(1, 1, 0);
  camera.up = Vec3::UnitY();
  camera.fovDeg = 30;
  return camera;
}

TEST(Picking, ProjectsAsAPinholeDoes) {
  const Scene scene = test::sampleScene();
  const ScreenMesh screen(scene.hairMesh, above(), 400, 200);
  EXPECT_TRUE(screen.project(Vec3(1, 1, 0)).px.isApprox(Vec2(200, 100)));
  // Half the picture's height is 20 · tan 15° at the target's depth.
  const ScreenPoint top = screen.project(Vec3(1, 1 + 20 * std::tan(15 * M_PI / 180), 0));
  EXPECT_TRUE(top.px.isApprox(Vec2(200, 0), 1e-9) || top.px.y() < 1e-9);
  EXPECT_DOUBLE_EQ(top.depth, 20);
  EXPECT_LT(screen.project(Vec3(1, 1, 21)).depth, 0);
}

TEST(Picking, FindsWhatIsInFront) {
  const Scene scene = test::sampleScene();
  const ScreenMesh screen(scene.hairMesh, above(), 400, 400);
  // The tip of bundle 3, seen from above, hides its root: the sample's layers go up along z.
  const Bundle& bundle = scene.hairMesh.bundles()[3];
  Vec3 middle = Vec3::Zero();
  for (std::uint32_t v : bundle.face(bundle.height())) middle += 0.25 * scene.hairMesh.position(v);
  EXPECT_EQ(screen.faceAt(screen.project(middle).px), (FaceRef{bundle.id, bundle.height()}));
  const std::uint32_t corner = bundle.face(bundle.height())[2];
  EXPECT_EQ(screen.vertexAt(screen.vertices()[corner].px + Vec2(1, 1), 6),
            scene.hairMesh.vertices()[corner].id);
  EXPECT_EQ(screen.vertexAt(Vec2(2, 2), 6), std::nullopt);
  const std::uint32_t next = bundle.face(bundle.height())[3];
  const Vec2 half = 0.5 * (screen.vertices()[corner].px + screen.vertices()[next].px);
  EXPECT_EQ(screen.edgeAt(half, 4), canonicalEdge(scene.hairMesh, {bundle.id, bundle.height(), 2}));
}

TEST(Picking, HiddenBundlesAreNotThere) {
  const Scene scene = test::sampleScene();
  std::vector<BundleId> hidden;
  for (const Bundle& bundle : scene.hairMesh.bundles()) hidden.push_back(bundle.id);
  const std::vector<BundleId> all = hidden;
  hidden.pop_back();
  const std::vector<Vec2> everything{{0, 0}, {400, 0}, {400, 400}, {0, 400}};
  PickOptions options;
  options.internal = true;
  const ScreenMesh open(scene.hairMesh, above(), 400, 400, options);
  options.hidden = hidden;
  const ScreenMesh some(scene.hairMesh, above(), 400, 400, options);
  options.hidden = all;
  const ScreenMesh none(scene.hairMesh, above(), 400, 400, options);
  EXPECT_EQ(open.inside(everything, SelectKind::Face), allOf(scene.hairMesh, SelectKind::Face));
  EXPECT_EQ(open.inside(everything, SelectKind::Vertex), allOf(scene.hairMesh, SelectKind::Vertex));
  EXPECT_EQ(some.inside(everything, SelectKind::Face).faces.size(),
            scene.hairMesh.bundles().back().height() + 1);
  EXPECT_TRUE(none.inside(everything, SelectKind::Edge).empty());
}

TEST(Picking, TheHeadHidesWhatIsBehindIt) {
  const Scene scene = test::sampleScene();
  PolygonMesh plate;  // between the camera and the hair
  plate.positions = {Vec3(-9, -9, 8), Vec3(9, -9, 8), Vec3(9, 9, 8), Vec3(-9, 9, 8)};
  plate.faceOffsets = {0, 4};
  plate.corners = {0, 1, 2, 3};
  const Surface head(plate);
  PickOptions options;
  options.occluder = &head;
  const std::vector<Vec2> everything{{0, 0}, {400, 0}, {400, 400}, {0, 400}};
  EXPECT_TRUE(
      ScreenMesh(scene.hairMesh, above(), 400, 400, options).inside(everything, SelectKind::Vertex).empty());
}

TEST(Picking, PolygonsByTheEvenOddRule) {
  const std::vector<Vec2> lasso{{0, 0}, {10, 0}, {10, 10}, {5, 3}, {0, 10}};
  EXPECT_TRUE(insidePolygon({1, 1}, lasso));
  EXPECT_FALSE(insidePolygon({5, 8}, lasso)) << "in the notch";
  EXPECT_FALSE(insidePolygon({-1, 5}, lasso));
  EXPECT_FALSE(insidePolygon({1, 1}, {}));
}

TEST(Navigation, OrbitKeepsDistanceAndTarget) {
  for (UpAxis axis : {UpAxis::Y, UpAxis::Z}) {
    const Camera start = frameBox({Vec3(-1, -2, -3), Vec3(3, 2, 1)}, axis, 20, 10);
    const Camera turned = orbit(start, axis, 35, -25);
    EXPECT_NEAR(azimuthDegOf(turned, axis), 55, 1e-9);
    EXPECT_NEAR(elevationDegOf(turned, axis), -15, 1e-9);
    EXPECT_NEAR((turned.eye - turned.target).norm(), (start.eye - start.target).norm(), 1e-12);
    EXPECT_NEAR(elevationDegOf(orbit(start, axis, 0, 500), axis), 89, 1e-9);
    EXPECT_TRUE(orbit(turned, axis, -35, 25).eye.isApprox(start.eye, 1e-12));
  }
}

TEST(Navigation, PanMovesTheTargetByPixels) {
  const Scene scene = test::sampleScene();
  const Vec3 target = above().target;
  const Camera moved = pan(above(), 30, -12, 400);
  const ScreenPoint now = ScreenMesh(scene.hairMesh, moved, 400, 400).project(target);
  EXPECT_TRUE(now.px.isApprox(Vec2(230, 188), 1e-9));
}

TEST(Navigation, ALongLensShowsTheTargetAlikeAndNoPerspective) {
  const Scene scene = test::sampleScene();
  const Camera parallel = withLens(above(), kParallelFovDeg);
  const ScreenMesh near(scene.hairMesh, above(), 400, 400), far(scene.hairMesh, parallel, 400, 400);
  const Vec3 beside(2, 1, 0), higher(2, 1, 1);
  EXPECT_TRUE(near.project(beside).px.isApprox(far.project(beside).px, 1e-9));
  EXPECT_GT((near.project(beside).px - near.project(higher).px).norm(), 1.5);
  EXPECT_LT((far.project(beside).px - far.project(higher).px).norm(), 0.1) << "pixels";
}

TEST(Picking, WhileSomethingIsDraggedWhatWasHiddenStaysSo) {
  Scene scene = test::sampleScene();
  PolygonMesh lid;  // over the left half, between the hair and the eye
  lid.positions = {{-9, -9, 10}, {1, -9, 10}, {1, 9, 10}, {-9, 9, 10}};
  lid.addFace(std::vector<std::uint32_t>{0, 1, 2, 3});
  const Surface head(lid);
  const auto parts = std::make_shared<const PickParts>(pickParts(scene.hairMesh, {}, true));
  const HairMesh before = scene.hairMesh;
  const ScreenMesh still(before, parts, above(), 400, 400, &head);
  for (std::uint32_t v = 0; v < before.vertices().size(); ++v)
    scene.hairMesh.setPosition(v, before.position(v) + Vec3(9, 0, 0));
  const ScreenMesh dragged(scene.hairMesh, parts, above(), 400, 400, &head, &still, true);
  const ScreenMesh after(scene.hairMesh, parts, above(), 400, 400, &head, &still);
  std::size_t hidden = 0;
  for (std::uint32_t v = 0; v < before.vertices().size(); ++v) {
    hidden += !still.pickable(v);
    EXPECT_EQ(dragged.pickable(v), still.pickable(v));
    EXPECT_TRUE(after.pickable(v)) << "out from under the lid";
    EXPECT_EQ(dragged.vertices()[v].px, after.vertices()[v].px);
  }
  EXPECT_GT(hidden, 0u);
}

}  // namespace
}  // namespace coif
