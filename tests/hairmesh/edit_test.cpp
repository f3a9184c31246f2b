#include "coif/hairmesh/edit.h"

#include <algorithm>
#include <cmath>

#include "coif/hairmesh/operations.h"
#include "hairmesh/test_meshes.h"

namespace coif {
namespace {

using Indices = std::vector<std::uint32_t>;
constexpr double kTiny = 1e-14;  // a few roundings of numbers of size one

HairMesh tallCap() {
  HairMesh mesh = capMesh(6);
  for (int i = 0; i < 2; ++i) EXPECT_TRUE(extrudeFaces(mesh, allBundles(mesh), {.distance = 0.3}).ok());
  return mesh;
}

TEST(Select, LayersBundlesColumnsAndStrips) {
  HairMesh mesh = gridMesh(3, 2);
  ASSERT_TRUE(extrudeFaces(mesh, allBundles(mesh), {.distance = 1}).ok());
  EXPECT_EQ(verticesOfLayer(mesh, 1).size(), 12u);
  EXPECT_EQ(verticesOfBundle(mesh, BundleId{0}, 0).value(), (Indices{0, 1, 4, 5}));
  EXPECT_EQ(verticesOfBundle(mesh, BundleId{0}).value().size(), 8u);
  EXPECT_EQ(columnOf(mesh, 5).value().size(), 2u);
  EXPECT_EQ(columnOf(mesh, columnOf(mesh, 5).value()[1]).value(), columnOf(mesh, 5).value());
  EXPECT_EQ(connectedBundles(mesh, BundleId{0}, 1).value().size(), 6u);
  EXPECT_EQ(quadStrip(mesh, {BundleId{1}, 0, 1}).value(), (Indices{0, 1, 2}));
  EXPECT_EQ(quadStrip(mesh, {BundleId{1}, 0, 2}).value(), (Indices{1, 4}));
  EXPECT_EQ(columnOf(mesh, 99).error().text(), "vertex index 99: the mesh has no such vertex");
  EXPECT_EQ(verticesOfBundle(mesh, BundleId{0}, 2).error().code, ErrorCode::NotFound);
}

TEST(Select, ComponentsFollowSeparation) {
  HairMesh mesh = gridMesh(2, 2);
  ASSERT_TRUE(extrudeFaces(mesh, std::vector{BundleId{0}, BundleId{1}}, {.distance = 1}).ok());
  ASSERT_TRUE(extrudeFaces(mesh, std::vector{BundleId{2}, BundleId{3}}, {.distance = 1}).ok());
  EXPECT_EQ(connectedBundles(mesh, BundleId{0}, 1).value(), (Indices{0, 1}));
  EXPECT_EQ(connectedBundles(mesh, BundleId{0}, 0).value().size(), 4u);
}

TEST(Select, ClosedStripOnATorus) {
  // 4 × 3 quads wrapped both ways.
  std::vector<Vec3> p;
  std::vector<std::uint32_t> offsets{0}, corners;
  for (std::uint32_t i = 0; i < 4; ++i) {
    for (std::uint32_t j = 0; j < 3; ++j) {
      const double a = i * M_PI / 2, b = j * 2 * M_PI / 3, r = 3 + std::cos(b);
      p.emplace_back(r * std::cos(a), r * std::sin(a), std::sin(b));
      const std::uint32_t i1 = (i + 1) % 4, j1 = (j + 1) % 3;
      corners.insert(corners.end(), {3 * i + j, 3 * i1 + j, 3 * i1 + j1, 3 * i + j1});
      offsets.push_back(std::uint32_t(corners.size()));
    }
  }
  const HairMesh mesh = HairMesh::fromRoot(p, offsets, corners).value();
  EXPECT_EQ(quadStrip(mesh, {BundleId{0}, 0, 1}).value(), (Indices{0, 3, 6, 9}));
  EXPECT_EQ(quadStrip(mesh, {BundleId{0}, 0, 2}).value(), (Indices{0, 1, 2}));
}

TEST(Select, SoftFalloff) {
  const HairMesh mesh = gridMesh(4, 1);
  const Indices selection{0};
  const VertexWeights weights = softSelection(mesh, selection, 2).value();
  EXPECT_EQ(weights[0], 1);
  EXPECT_NEAR(weights[1], 0.5, kTiny);  // half way: 3/4 − 2/8
  EXPECT_EQ(weights[2], 0);
  EXPECT_EQ(softSelection(mesh, selection).value()[1], 0);
  EXPECT_FALSE(softSelection(mesh, selection, -1).ok());
  EXPECT_FALSE(softSelection(mesh, selection, NAN).ok());
}

TEST(Move, TranslateScaleRotate) {
  HairMesh mesh = gridMesh(1, 1);
  const VertexWeights half(4, 0.5), full(4, 1);
  ASSERT_TRUE(translate(mesh, half, {0, 0, 2}).ok());
  EXPECT_EQ(mesh.position(3), Vec3(1, 1, 1));
  ASSERT_TRUE(scale(mesh, full, {1, 1, 0}, {3, 1, 2}).ok());
  EXPECT_EQ(mesh.position(0), Vec3(-2, 0, 2));
  ASSERT_TRUE(rotate(mesh, full, {0, 0, 0}, {0, 0, 5}, M_PI / 2).ok());
  EXPECT_NEAR((mesh.position(0) - Vec3(0, -2, 2)).norm(), 0, kTiny);
  const HairMesh before = mesh;
  EXPECT_FALSE(translate(mesh, full, {0, NAN, 0}).ok());
  EXPECT_FALSE(translate(mesh, VertexWeights(3, 1), {0, 0, 0}).ok());
  EXPECT_FALSE(translate(mesh, VertexWeights(4, 2), {0, 0, 0}).ok());
  EXPECT_FALSE(rotate(mesh, full, {0, 0, 0}, {0, 0, 0}, 1).ok());
  EXPECT_FALSE(smooth(mesh, full, 2).ok());
  EXPECT_EQ(mesh, before);
}

TEST(Move, SmoothGoesToTheMeanAndKeepsTheBorderStraight) {
  HairMesh mesh = gridMesh(2, 2);
  mesh.setPosition(4, {1, 1, 8});
  ASSERT_TRUE(smooth(mesh, VertexWeights(9, 1), 0.5, 1).ok());
  EXPECT_EQ(mesh.position(4), Vec3(1, 1, 4));  // half way to the mean of its four neighbours, at z = 0
  EXPECT_EQ(mesh.position(1), Vec3(1, 0, 0));  // the border sees the border only
}

TEST(Mirror, EveryElementOfASymmetricMeshHasItsPartner) {
  const HairMesh mesh = tallCap();
  const Mirror mirror = findMirror(mesh, {0, 0, 0}, {2, 0, 0}, 1e-6).value();
  EXPECT_TRUE(mirror.complete());
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
    const Vec3 p = mesh.position(v), q = mesh.position(mirror.vertexPartner[v]);
    EXPECT_NEAR((mirror.image(p) - q).norm(), 0, 1e-12);  // normals of both sides differ by roundings
    EXPECT_EQ(mirror.vertexPartner[mirror.vertexPartner[v]], v);
  }
  // An edge and its image have ends that are partners.
  for (const Bundle& bundle : mesh.bundles()) {
    for (std::uint32_t side = 0; side < 4; ++side) {
      const EdgeRef image = mirrored(mesh, mirror, EdgeRef{bundle.id, 1, side}).value();
      const auto other = mesh.bundles()[mesh.indexOf(image.bundle)].face(1);
      EXPECT_EQ(mirror.vertexPartner[bundle.face(1)[side]], other[(image.side + 1) % 4]);
      EXPECT_EQ(mirror.vertexPartner[bundle.face(1)[(side + 1) % 4]], other[image.side]);
    }
  }
}

TEST(Mirror, SymmetricOperationsKeepTheMeshSymmetric) {
  HairMesh mesh = tallCap();
  const auto find = [&] { return findMirror(mesh, {0, 0, 0}, {1, 0, 0}, 1e-6).value(); };
  const auto separate = [](HairMesh& m, EdgeRef e) { return separateEdge(m, e); };
  ASSERT_TRUE(applySymmetrically(mesh, find(), EdgeRef{BundleId{1}, 1, 2}, separate).ok());
  ASSERT_TRUE(applySymmetrically(mesh, find(), EdgeRef{BundleId{2}, 1, 1}, separate).ok());  // on the plane
  const auto insert = [](HairMesh& m, FaceRef f) { return insertLayer(m, f, 0.5); };
  ASSERT_TRUE(applySymmetrically(mesh, find(), FaceRef{BundleId{0}, 1}, insert).ok());
  EXPECT_EQ(mesh.bundles()[0].height(), 3u);  // all bundles are connected: one layer, not two
  // Bundle 1 and its image, and a bundle that borders the plane on a strip of an odd grid.
  const auto divide = [](HairMesh& m, EdgeRef e) { return divideEdge(m, e, 0.5); };
  ASSERT_TRUE(applySymmetrically(mesh, find(), EdgeRef{BundleId{31}, 0, 0}, divide).ok());
  EXPECT_EQ(mesh.bundles()[34].corners, 5u);
  HairMesh odd = gridMesh(3, 1);  // the middle quad is its own image
  const Mirror across = findMirror(odd, {1.5, 0, 0}, {1, 0, 0}, 1e-6).value();
  EXPECT_TRUE(across.complete());
  ASSERT_TRUE(applySymmetrically(odd, across, EdgeRef{BundleId{1}, 0, 1}, divide).ok());
  EXPECT_EQ(odd.bundles()[1].corners, 6u);
  EXPECT_TRUE(findMirror(odd, {1.5, 0, 0}, {1, 0, 0}, 1e-6)->complete());
  const auto ids = withMirrored(mesh, find(), std::vector{BundleId{7}, BundleId{14}}).value();
  EXPECT_EQ(ids, (std::vector{BundleId{7}, BundleId{10}, BundleId{14}, BundleId{15}}));
  ASSERT_TRUE(subdivide(mesh, ids).ok());
  expectSound(mesh);
  EXPECT_TRUE(find().complete());
}

TEST(Mirror, ARefusalOnEitherSideChangesNothing) {
  HairMesh mesh = tallCap();
  ASSERT_TRUE(deleteFaces(mesh, std::vector{BundleId{5}}).ok());
  const HairMesh before = mesh;
  const Mirror mirror = findMirror(mesh, {0, 0, 0}, {1, 0, 0}, 1e-6).value();
  EXPECT_FALSE(mirror.complete());
  const auto insert = [](HairMesh& m, FaceRef f) { return insertLayer(m, f, 0.5); };
  EXPECT_EQ(applySymmetrically(mesh, mirror, FaceRef{BundleId{0}, 2}, insert).error().text(),
            "bundle 0, layer 2: the face has no mirror image");
  EXPECT_EQ(mesh, before);
  EXPECT_FALSE(findMirror(mesh, {0, 0, 0}, {0, 0, 0}, 1e-6).ok());
  EXPECT_FALSE(findMirror(mesh, {0, 0, 0}, {1, 0, 0}, 0).ok());
}

TEST(Mirror, MovesAndSymmetrise) {
  HairMesh mesh = tallCap();
  const Mirror mirror = findMirror(mesh, {0, 0, 0}, {1, 0, 0}, 1e-6).value();
  std::vector<Vec3> moves(mesh.vertices().size(), Vec3::Zero());
  const std::uint32_t left = 0, middle = 3;  // vertex 3 of 0…6 in a row lies on the plane
  const Vec3 p = mesh.position(left), q = mesh.position(mirror.vertexPartner[left]),
             m = mesh.position(middle);
  moves[left] = {0.1, 0.2, 0.3};
  moves[middle] = {0.4, 0, 0.5};
  ASSERT_TRUE(moveSymmetrically(mesh, mirror, moves).ok());
  EXPECT_NEAR((mesh.position(left) - (p + Vec3(0.1, 0.2, 0.3))).norm(), 0, kTiny);
  EXPECT_NEAR((mesh.position(mirror.vertexPartner[left]) - (q + Vec3(-0.1, 0.2, 0.3))).norm(), 0, kTiny);
  EXPECT_NEAR((mesh.position(middle) - (m + Vec3(0, 0, 0.5))).norm(), 0, kTiny);

  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
    mesh.setPosition(v, mesh.position(v) + 0.01 * Vec3(std::sin(v), std::cos(3 * v), std::sin(7 * v)));
  }
  const HairMesh rough = mesh;
  EXPECT_EQ(symmetrise(mesh, mirror).value(), 0u);
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
    EXPECT_NEAR((mirror.image(mesh.position(v)) - mesh.position(mirror.vertexPartner[v])).norm(), 0, kTiny);
    std::uint32_t root = v;
    while (mesh.vertices()[root].parent != kNone) root = mesh.vertices()[root].parent;
    // The side that the normal points to is the one that is copied.
    if (rough.position(root).x() > 0.1) {
      EXPECT_EQ(mesh.position(v), rough.position(v));
    }
  }
}

}  // namespace
}  // namespace coif
