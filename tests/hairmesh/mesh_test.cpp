#include "coif/hairmesh/hair_mesh.h"
#include "coif/hairmesh/operations.h"
#include "hairmesh/test_meshes.h"

namespace coif {
namespace {

using Ids = std::vector<BundleId>;

TEST(HairMesh, RootKeepsTheInputsNumbering) {
  const HairMesh mesh = gridMesh(2, 1);
  EXPECT_EQ(mesh.vertices().size(), 6u);
  EXPECT_EQ(mesh.bundles().size(), 2u);
  EXPECT_EQ(mesh.bundles()[1].vertices, (std::vector<std::uint32_t>{1, 2, 5, 4}));
  EXPECT_EQ(mesh.layerCount(), 1u);
  EXPECT_EQ(mesh.indexOf(VertexId{4}), 4u);
  EXPECT_EQ(mesh.indexOf(VertexId{6}), kNone);
  EXPECT_EQ(mesh.indexOf(BundleId{2}), kNone);
}

TEST(HairMesh, RootDropsUnusedVerticesAndSplitsBowTies) {
  const std::vector<Vec3> p{{0, 0, 0}, {9, 9, 9}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}};
  const std::vector<std::uint32_t> offsets{0, 3, 6}, corners{0, 2, 3, 0, 4, 5};
  const HairMesh mesh = HairMesh::fromRoot(p, offsets, corners).value();
  EXPECT_EQ(mesh.vertices().size(), 6u);  // five used, and a second one at the origin
  EXPECT_NE(mesh.bundles()[0].vertices[0], mesh.bundles()[1].vertices[0]);
  EXPECT_EQ(mesh.position(mesh.bundles()[1].vertices[0]), Vec3(0, 0, 0));
}

TEST(HairMesh, RootRefusesWhatIsNoManifold) {
  const std::vector<Vec3> p{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}};
  const auto build = [&](std::vector<std::uint32_t> offsets, std::vector<std::uint32_t> corners) {
    return HairMesh::fromRoot(p, offsets, corners);
  };
  EXPECT_EQ(build({0, 3, 6, 9}, {0, 1, 2, 1, 0, 3, 0, 1, 4}).error().code, ErrorCode::Degenerate);
  EXPECT_EQ(build({0, 3, 6}, {0, 1, 2, 0, 1, 3}).error().text(),
            "face 1: two faces run along an edge the same way");
  EXPECT_EQ(build({0, 3}, {0, 1, 7}).error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(build({0, 2}, {0, 1}).error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(build({0, 4}, {0, 1, 2, 1}).error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(build({0, 5}, {0, 1, 2}).error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(build({}, {}).error().code, ErrorCode::InvalidArgument);
  std::vector<Vec3> broken = p;
  broken[2].x() = std::nan("");
  const std::vector<std::uint32_t> offsets{0, 3}, corners{0, 1, 2};
  EXPECT_EQ(HairMesh::fromRoot(broken, offsets, corners).error().text(),
            "vertex 2: a position is not finite");
}

TEST(HairMesh, FromPartsGivesBackTheMeshAndChecksIt) {
  HairMesh mesh = gridMesh(3, 3);
  ASSERT_TRUE(extrudeFaces(mesh, allBundles(mesh), {.distance = 1}).ok());
  const auto rebuild = [&](auto change) {
    std::vector<HairVertex> vertices(mesh.vertices().begin(), mesh.vertices().end());
    std::vector<Bundle> bundles(mesh.bundles().begin(), mesh.bundles().end());
    std::vector<EdgeSplit> splits(mesh.splits().begin(), mesh.splits().end());
    change(vertices, bundles, splits);
    return HairMesh::fromParts(vertices, bundles, splits, {"hair"}, mesh.nextVertexId(), mesh.nextBundleId());
  };
  EXPECT_EQ(rebuild([](auto&, auto&, auto&) {}).value(), mesh);
  const auto faultOf = [&](auto change) {
    const auto result = rebuild(change);
    return result.ok() ? std::string("none")
                       : result.error().message.substr(0, result.error().message.find(':'));
  };
  EXPECT_EQ(faultOf([](auto& v, auto&, auto&) { v[3].position.y() = INFINITY; }), "finite");
  EXPECT_EQ(faultOf([](auto& v, auto&, auto&) { std::swap(v[3].id, v[4].id); }), "id");
  EXPECT_EQ(faultOf([](auto& v, auto&, auto&) { v[20].parent = 5; }), "parent");
  EXPECT_EQ(faultOf([](auto& v, auto&, auto&) { v[20].parent = 21; }), "parent");
  EXPECT_EQ(faultOf([](auto& v, auto&, auto&) { v[20].welded = true; }), "bow-tie");
  EXPECT_EQ(faultOf([](auto&, auto& b, auto&) { b[2].vertices.pop_back(); }), "corner-count");
  EXPECT_EQ(faultOf([](auto&, auto& b, auto&) { b[2].vertices[0] = 99; }), "index");
  EXPECT_EQ(faultOf([](auto&, auto& b, auto&) { b[2].vertices[0] = b[2].vertices[1]; }), "face-once");
  EXPECT_EQ(faultOf([](auto&, auto& b, auto&) { b[2].vertices[4] = b[2].vertices[0]; }), "layer");
  EXPECT_EQ(faultOf([](auto&, auto& b, auto&) { b[2].group = 1; }), "group");
  EXPECT_EQ(faultOf([](auto& v, auto& b, auto&) {
              b.pop_back();
              (void)v;
            }),
            "unused");
  EXPECT_EQ(faultOf([](auto&, auto& b, auto&) { std::swap(b[2].vertices[0], b[2].vertices[1]); }), "parent");
  EXPECT_EQ(faultOf([](auto&, auto&, auto& s) { s.push_back({0, 1, 1}); }), "root");  // a boundary edge
  EXPECT_EQ(faultOf([](auto&, auto&, auto& s) { s.push_back({1, 5, 2}); }), "split");
  EXPECT_EQ(faultOf([](auto&, auto&, auto& s) { s.push_back({1, 5, 0}); }), "split");
}

TEST(HairMesh, ExternalVerticesAndSideQuadsOfABlock) {
  HairMesh mesh = gridMesh(3, 3);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(extrudeFaces(mesh, allBundles(mesh), {.distance = 1}).ok());
  expectSound(mesh);
  const auto external = externalVertices(mesh);
  std::size_t internal = 0;
  for (std::size_t v = 0; v < external.size(); ++v) internal += !external[v];
  EXPECT_EQ(internal, 8u);  // 2 × 2 inner columns, layers 1 and 2 of 0…3
  const auto quads = sideQuads(mesh);
  EXPECT_EQ(quads.size(), 24u * 3);  // 24 edges of a 3 × 3 grid
  std::size_t exposed = 0;
  for (const SideQuad& q : quads) {
    exposed += q.exposed;
    EXPECT_EQ(mesh.vertices()[q.c].parent, q.a);
    EXPECT_EQ(mesh.vertices()[q.d].parent, q.b);
  }
  EXPECT_EQ(exposed, 12u * 3);
}

TEST(Extrude, NeighboursTogetherShareOthersDoNot) {
  HairMesh together = gridMesh(2, 1), apart = gridMesh(2, 1);
  ASSERT_TRUE(extrudeFaces(together, Ids{BundleId{0}, BundleId{1}}, {.distance = 2}).ok());
  EXPECT_EQ(together.vertices().size(), 12u);
  EXPECT_EQ(together.position(6), Vec3(0, 0, 2));
  ASSERT_TRUE(extrudeFaces(apart, Ids{BundleId{0}}, {.distance = 1}).ok());
  EXPECT_TRUE(apart.splits().empty());
  ASSERT_TRUE(extrudeFaces(apart, Ids{BundleId{1}}, {.distance = 1}).ok());
  EXPECT_EQ(apart.vertices().size(), 14u);
  ASSERT_EQ(apart.splits().size(), 1u);
  EXPECT_EQ(apart.splits()[0], (EdgeSplit{1, 4, 1}));
  expectSound(apart);
}

TEST(Extrude, FacesThatOnlyTouchDoNotShare) {
  HairMesh mesh = gridMesh(2, 2);
  ASSERT_TRUE(extrudeFaces(mesh, Ids{BundleId{0}, BundleId{3}}, {.distance = 1}).ok());
  EXPECT_EQ(mesh.vertices().size(), 9u + 8u);
  expectSound(mesh);
}

TEST(Delete, RootFaceThatLeavesABowTieSplitsTheVertex) {
  HairMesh mesh = gridMesh(2, 2);
  const auto created = deleteFaces(mesh, Ids{BundleId{1}, BundleId{2}});
  ASSERT_TRUE(created.ok());
  EXPECT_EQ(created->vertices.size(), 1u);
  EXPECT_EQ(mesh.vertices().size(), 8u);
  EXPECT_EQ(mesh.bundles().size(), 2u);
  expectSound(mesh);
}

TEST(Delete, EverythingLeavesAnEmptyMesh) {
  HairMesh mesh = gridMesh(2, 2);
  ASSERT_TRUE(deleteFaces(mesh, allBundles(mesh)).ok());
  EXPECT_EQ(mesh.layerCount(), 0u);
  EXPECT_TRUE(mesh.vertices().empty());
  expectSound(mesh);
  EXPECT_TRUE(sideQuads(mesh).empty());
}

}  // namespace
}  // namespace coif
