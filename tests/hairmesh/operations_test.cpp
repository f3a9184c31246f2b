// Every topological operation on meshes small enough to check by hand, and every refusal.
#include "coif/hairmesh/operations.h"

#include <algorithm>

#include "hairmesh/test_meshes.h"

namespace coif {
namespace {

using Ids = std::vector<BundleId>;
constexpr BundleId operator""_b(unsigned long long id) {
  return BundleId(id);
}
constexpr VertexId operator""_v(unsigned long long id) {
  return VertexId(id);
}

/// nx × ny quads with `layers` extruded unit layers.
HairMesh block(std::uint32_t nx, std::uint32_t ny, int layers) {
  HairMesh mesh = gridMesh(nx, ny);
  for (int i = 0; i < layers; ++i) EXPECT_TRUE(extrudeFaces(mesh, allBundles(mesh), {.distance = 1}).ok());
  return mesh;
}

std::uint32_t corner(const HairMesh& mesh, std::uint32_t bundle, std::uint32_t layer, std::uint32_t i) {
  return mesh.bundles()[bundle].face(layer)[i];
}

template <class Operation>
std::string refusal(const HairMesh& mesh, Operation operation) {
  HairMesh copy = mesh;
  const auto result = operation(copy);
  EXPECT_EQ(copy, mesh) << "a refusal must change nothing";
  return result.ok() ? "none" : result.error().text();
}

TEST(Extrude, OffsetsDirectionAndNormals) {
  HairMesh mesh = gridMesh(1, 1);
  std::vector<Vec3> offsets{{1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}};
  ASSERT_TRUE(extrudeFaces(mesh, Ids{0_b}, {.offsets = offsets}).ok());
  EXPECT_EQ(mesh.position(corner(mesh, 0, 1, 2)), Vec3(1 + 4, 1, 0));  // corner 2 is vertex 3
  ASSERT_TRUE(extrudeFaces(mesh, Ids{0_b}, {.direction = Vec3(0, 0, 5)}).ok());
  EXPECT_EQ(mesh.position(corner(mesh, 0, 2, 2)), Vec3(5, 1, 5));
  expectSound(mesh);
}

TEST(Extrude, InheritsPinsAndKeepsGroups) {
  HairMesh mesh = gridMesh(1, 1);
  mesh.setPinned(2, true);
  mesh.setGroup(0, mesh.addGroup("fringe"));
  ASSERT_TRUE(extrudeFaces(mesh, Ids{0_b}, {.distance = 1}).ok());
  EXPECT_TRUE(mesh.vertices()[7].pinned);  // corner 3 is vertex 2
  EXPECT_FALSE(mesh.vertices()[5].pinned);
  EXPECT_EQ(mesh.bundles()[0].group, 1u);
}

TEST(Extrude, Refuses) {
  const HairMesh mesh = block(2, 1, 1);
  const auto extrude = [&](Ids ids, ExtrudeOptions options) {
    return refusal(mesh, [&](HairMesh& m) { return extrudeFaces(m, ids, options); });
  };
  EXPECT_EQ(extrude({}, {}), "selection: no bundle is selected");
  EXPECT_EQ(extrude({0_b, 0_b}, {}), "bundle 0: the bundle is selected twice");
  EXPECT_EQ(extrude({7_b}, {}), "bundle 7: the mesh has no such bundle");
  EXPECT_EQ(extrude({0_b}, {.distance = NAN}), "extrude options: the displacement is not finite");
  EXPECT_EQ(extrude({0_b}, {.offsets = {Vec3::Zero()}}),
            "extrude options: there must be one offset a vertex of the mesh");
  const std::vector<FaceRef> low{{0_b, 0}}, high{{0_b, 2}};
  EXPECT_EQ(refusal(mesh, [&](HairMesh& m) { return extrudeFaces(m, low); }),
            "bundle 0, layer 0: the face is not its bundle's tip");
  EXPECT_EQ(refusal(mesh, [&](HairMesh& m) { return deleteFaces(m, low); }),
            "bundle 0, layer 0: the face is not its bundle's tip");
  EXPECT_EQ(refusal(mesh, [&](HairMesh& m) { return deleteFaces(m, high); }),
            "bundle 0, layer 2: the bundle ends below this layer");
  EXPECT_EQ(refusal(mesh, [&](HairMesh& m) { return deleteFaces(m, Ids{}); }),
            "selection: no bundle is selected");
}

TEST(Extrude, RefusesWhereThereIsNoDirection) {
  HairMesh flat = gridMesh(1, 1);
  for (std::uint32_t v = 0; v < 4; ++v) flat.setPosition(v, {0, 0, 0});
  EXPECT_EQ(refusal(flat, [](HairMesh& m) { return extrudeFaces(m, Ids{0_b}, {.distance = 1}); }),
            "vertex 0: the faces at the vertex have no normal to extrude along");
}

TEST(Delete, TipLeavesTheNeighboursTogetherOrSplitsThem) {
  HairMesh mesh = block(2, 2, 1);
  ASSERT_TRUE(deleteFaces(mesh, Ids{1_b}).ok());
  EXPECT_EQ(mesh.vertices().size(), 17u);  // only the corner of bundle 1 went
  const auto created = deleteFaces(mesh, Ids{2_b});
  ASSERT_TRUE(created.ok());
  EXPECT_EQ(created->vertices.size(), 1u);  // bundles 0 and 3 touched in the middle only
  EXPECT_NE(corner(mesh, 0, 1, 2), corner(mesh, 2 + 1, 1, 0));
  expectSound(mesh);
}

TEST(Layer, InsertTakesTheConnectedBundlesOnly) {
  HairMesh mesh = block(2, 1, 1);
  ASSERT_TRUE(separateEdge(mesh, {0_b, 1, 1}).ok());
  const auto created = insertLayer(mesh, {0_b, 1}, 0.25);
  ASSERT_TRUE(created.ok());
  EXPECT_EQ(created->faces, (std::vector<FaceRef>{{0_b, 1}}));
  EXPECT_EQ(mesh.bundles()[0].height(), 2u);
  EXPECT_EQ(mesh.bundles()[1].height(), 1u);
  EXPECT_EQ(mesh.position(corner(mesh, 0, 1, 0)), Vec3(0, 0, 0.25));
  EXPECT_EQ(mesh.position(corner(mesh, 0, 2, 0)), Vec3(0, 0, 1));
  expectSound(mesh);
}

TEST(Layer, RemoveAtTheTipIsFaceDelete) {
  HairMesh removed = block(2, 2, 2), deleted = removed;
  ASSERT_TRUE(removeLayer(removed, {0_b, 2}).ok());
  ASSERT_TRUE(deleteFaces(deleted, allBundles(deleted)).ok());
  EXPECT_EQ(removed, deleted);
}

TEST(Layer, RemoveGivesChildrenTheirGrandparents) {
  HairMesh mesh = block(1, 1, 2);
  ASSERT_TRUE(removeLayer(mesh, {0_b, 1}).ok());
  EXPECT_EQ(mesh.vertices().size(), 8u);
  EXPECT_EQ(mesh.position(corner(mesh, 0, 1, 3)), Vec3(0, 1, 2));
  EXPECT_EQ(mesh.vertices()[corner(mesh, 0, 1, 3)].parent, corner(mesh, 0, 0, 3));
  expectSound(mesh);
}

TEST(Layer, Refuses) {
  const HairMesh mesh = block(1, 1, 1);
  const auto insert = [&](FaceRef f, double t) {
    return refusal(mesh, [&](HairMesh& m) { return insertLayer(m, f, t); });
  };
  EXPECT_EQ(insert({0_b, 0}, 0.5),
            "bundle 0, layer 0: the root layer can neither be inserted before nor removed");
  EXPECT_EQ(insert({0_b, 1}, 0), "bundle 0, layer 1: t must lie between 0 and 1");
  EXPECT_EQ(insert({0_b, 1}, NAN), "bundle 0, layer 1: t must lie between 0 and 1");
  EXPECT_EQ(insert({0_b, 2}, 0.5), "bundle 0, layer 2: the bundle ends below this layer");
  EXPECT_EQ(refusal(mesh,
                    [](HairMesh& m) {
                      return removeLayer(m, {0_b, 0});
                    }),
            "bundle 0, layer 0: the root layer can neither be inserted before nor removed");
}

TEST(Separate, EdgeInsideIsASlitAndASecondOneOpensIt) {
  HairMesh mesh = block(3, 3, 2);
  const std::size_t before = mesh.vertices().size();
  // Bundle 4 is the middle; its side 0 borders bundle 1, both ends are inner vertices.
  const auto slit = separateEdge(mesh, {4_b, 1, 0});
  ASSERT_TRUE(slit.ok());
  EXPECT_TRUE(slit->vertices.empty());
  EXPECT_EQ(mesh.vertices().size(), before);
  ASSERT_EQ(mesh.splits().size(), 1u);
  EXPECT_EQ(mesh.splits()[0].layer, 1u);
  // Both sides are boundary edges now: their side quads are exposed, and the inner vertices external.
  const auto external = externalVertices(mesh);
  EXPECT_TRUE(external[corner(mesh, 4, 1, 0)] && external[corner(mesh, 4, 1, 1)]);
  EXPECT_FALSE(external[corner(mesh, 4, 1, 2)]);
  std::size_t exposed = 0;
  for (const SideQuad& quad : sideQuads(mesh)) exposed += quad.exposed;
  EXPECT_EQ(exposed, 12u * 2 + 2 * 2);
  // The next edge along the line: their common end falls apart, on both layers above the root.
  const auto open = separateEdge(mesh, {4_b, 1, 1});
  ASSERT_TRUE(open.ok());
  EXPECT_EQ(open->vertices.size(), 2u);
  expectSound(mesh);
}

TEST(Separate, EdgeAtTheBorderFallsApartAbove) {
  HairMesh mesh = block(2, 1, 3);
  const auto created = separateEdge(mesh, {0_b, 2, 1});
  ASSERT_TRUE(created.ok());
  EXPECT_EQ(created->vertices.size(), 4u);  // two ends, layers 2 and 3
  EXPECT_EQ(corner(mesh, 0, 1, 1), corner(mesh, 1, 1, 0));
  EXPECT_NE(corner(mesh, 0, 2, 1), corner(mesh, 1, 2, 0));
  EXPECT_EQ(mesh.position(corner(mesh, 0, 2, 1)), mesh.position(corner(mesh, 1, 2, 0)));
  expectSound(mesh);
}

TEST(Separate, VertexGivesEveryFaceItsOwn) {
  HairMesh mesh = block(2, 2, 2);
  const VertexId middle = mesh.vertices()[corner(mesh, 0, 1, 2)].id;
  const auto created = separateVertex(mesh, middle);
  ASSERT_TRUE(created.ok());
  // Three more in the middle and one more at the end of each of the four edges, on two layers.
  EXPECT_EQ(created->vertices.size(), 2u * (3 + 4));
  std::vector<std::uint32_t> tips{corner(mesh, 0, 2, 2), corner(mesh, 1, 2, 3), corner(mesh, 2, 2, 1),
                                  corner(mesh, 3, 2, 0)};
  std::sort(tips.begin(), tips.end());
  EXPECT_EQ(std::unique(tips.begin(), tips.end()), tips.end());
  expectSound(mesh);
}

TEST(Separate, Refuses) {
  const HairMesh mesh = block(2, 1, 1);
  const auto edge = [&](EdgeRef e) { return refusal(mesh, [&](HairMesh& m) { return separateEdge(m, e); }); };
  const auto vertex = [&](VertexId v) {
    return refusal(mesh, [&](HairMesh& m) { return separateVertex(m, v); });
  };
  EXPECT_EQ(edge({0_b, 0, 1}), "bundle 0, layer 0, side 1: an edge of the root layer cannot be separated");
  EXPECT_EQ(edge({0_b, 1, 0}), "bundle 0, layer 1, side 0: the edge is a boundary edge of its layer");
  EXPECT_EQ(edge({0_b, 1, 4}), "bundle 0, layer 1, side 4: the face has no such side");
  EXPECT_EQ(vertex(1_v), "vertex 1: a vertex of the root layer cannot be separated");
  EXPECT_EQ(vertex(6_v), "vertex 6: the vertex belongs to one face only");
  EXPECT_EQ(vertex(99_v), "vertex 99: the mesh has no such vertex");
  EXPECT_EQ(refusal(mesh,
                    [](HairMesh& m) {
                      return separateVertex(m, FaceRef{0_b, 1}, 4);
                    }),
            "bundle 0, layer 1, side 4: the face has no such side");
}

TEST(Weld, EdgeJoinsThereAndBelow) {
  HairMesh mesh = block(2, 1, 3);
  ASSERT_TRUE(separateEdge(mesh, {0_b, 1, 1}).ok());
  mesh.setPosition(corner(mesh, 1, 2, 0), {2, 0, 2});  // the other side stays at (1, 0, 2)
  const auto created = weldEdges(mesh, {0_b, 2, 1}, {1_b, 2, 3});
  ASSERT_TRUE(created.ok());
  EXPECT_EQ(created->vertices.size(), 4u);
  EXPECT_EQ(corner(mesh, 0, 1, 1), corner(mesh, 1, 1, 0));
  EXPECT_EQ(corner(mesh, 0, 2, 1), corner(mesh, 1, 2, 0));
  EXPECT_NE(corner(mesh, 0, 3, 1), corner(mesh, 1, 3, 0));
  EXPECT_EQ(mesh.position(corner(mesh, 0, 2, 1)), Vec3(1.5, 0, 2));
  ASSERT_EQ(mesh.splits().size(), 1u);
  EXPECT_EQ(mesh.splits()[0].layer, 3u);
  expectSound(mesh);
}

TEST(Weld, VerticesOfFacesThatOnlyTouchAreADeclaredBowTie) {
  HairMesh mesh = gridMesh(2, 2);
  ASSERT_TRUE(extrudeFaces(mesh, Ids{0_b, 3_b}, {.distance = 1}).ok());
  const VertexId a = mesh.vertices()[corner(mesh, 0, 1, 2)].id, b = mesh.vertices()[corner(mesh, 3, 1, 0)].id;
  const auto created = weldVertices(mesh, b, a, WeldPosition::First);
  ASSERT_TRUE(created.ok());
  EXPECT_EQ(created->vertices, std::vector{std::min(a, b)});
  const std::uint32_t v = corner(mesh, 0, 1, 2);
  EXPECT_EQ(v, corner(mesh, 3, 1, 0));
  EXPECT_TRUE(mesh.vertices()[v].welded);
  expectSound(mesh);
  // It outlives an extrusion (whose faces do not share), and goes with one of its faces.
  ASSERT_TRUE(extrudeFaces(mesh, Ids{0_b, 3_b}, {.distance = 1}).ok());
  EXPECT_NE(corner(mesh, 0, 2, 2), corner(mesh, 3, 2, 0));
  expectSound(mesh);
  ASSERT_TRUE(deleteFaces(mesh, Ids{3_b}).ok());
  ASSERT_TRUE(deleteFaces(mesh, Ids{3_b}).ok());
  EXPECT_FALSE(mesh.vertices()[corner(mesh, 0, 1, 2)].welded);
  expectSound(mesh);
}

/// Bundles 0, 1 and 3 around the middle of four on layer 1; 0 and 3 go on to layer 2, welded there above the
/// middle.
HairMesh weldedAbove() {
  HairMesh mesh = block(2, 2, 1);
  EXPECT_TRUE(deleteFaces(mesh, Ids{2_b}).ok());
  EXPECT_TRUE(extrudeFaces(mesh, Ids{0_b, 3_b}, {.distance = 1}).ok());
  const VertexId a = mesh.vertices()[corner(mesh, 0, 2, 2)].id, b = mesh.vertices()[corner(mesh, 3, 2, 0)].id;
  EXPECT_TRUE(weldVertices(mesh, a, b).ok());
  EXPECT_FALSE(mesh.vertices()[corner(mesh, 0, 1, 2)].welded);  // one fan there, through bundle 1
  return mesh;
}

TEST(Weld, HoldsTheVerticesBelowWhenAFaceIsDeleted) {
  HairMesh mesh = weldedAbove();
  ASSERT_TRUE(deleteFaces(mesh, Ids{1_b}).ok());
  EXPECT_EQ(corner(mesh, 0, 1, 2), corner(mesh, 3, 1, 0));
  EXPECT_TRUE(mesh.vertices()[corner(mesh, 0, 1, 2)].welded);
  EXPECT_EQ(corner(mesh, 0, 2, 2), corner(mesh, 3, 2, 0));
  expectSound(mesh);
  // But the root layer has no bow-ties, and so nothing above it has one between the two.
  ASSERT_TRUE(deleteFaces(mesh, Ids{1_b, 2_b}).ok());
  for (const std::uint32_t k : {0u, 1u, 2u}) {
    EXPECT_NE(mesh.bundles()[0].face(k)[2], mesh.bundles()[1].face(k)[0]) << k;
  }
  expectSound(mesh);
}

TEST(Weld, YieldsToASeparationBelow) {
  HairMesh mesh = weldedAbove();
  ASSERT_TRUE(separateEdge(mesh, {0_b, 1, 1}).ok());
  EXPECT_NE(corner(mesh, 0, 1, 2), corner(mesh, 3, 1, 0));
  EXPECT_NE(corner(mesh, 0, 2, 2), corner(mesh, 3, 2, 0));
  expectSound(mesh);
}

TEST(Weld, VerticesJoinTheEdgeOnceBothEndsMeet) {
  HairMesh mesh = block(2, 1, 1);
  ASSERT_TRUE(separateEdge(mesh, {0_b, 1, 1}).ok());
  const auto weld = [&](std::uint32_t i, std::uint32_t k) {
    return weldVertices(mesh, mesh.vertices()[corner(mesh, 0, 1, i)].id,
                        mesh.vertices()[corner(mesh, 1, 1, k)].id);
  };
  ASSERT_TRUE(weld(1, 0).ok());
  EXPECT_EQ(mesh.splits().size(), 1u);
  EXPECT_TRUE(mesh.vertices()[corner(mesh, 0, 1, 1)].welded);
  ASSERT_TRUE(weld(2, 3).ok());
  EXPECT_TRUE(mesh.splits().empty());
  EXPECT_FALSE(mesh.vertices()[corner(mesh, 0, 1, 1)].welded);
  expectSound(mesh);
}

TEST(Weld, Refuses) {
  HairMesh mesh = block(2, 1, 2);
  ASSERT_TRUE(separateEdge(mesh, {0_b, 2, 1}).ok());
  const auto edges = [&](EdgeRef a, EdgeRef b) {
    return refusal(mesh, [&](HairMesh& m) { return weldEdges(m, a, b); });
  };
  const auto vertices = [&](std::uint32_t a, std::uint32_t b) {
    return refusal(mesh,
                   [&](HairMesh& m) { return weldVertices(m, m.vertices()[a].id, m.vertices()[b].id); });
  };
  EXPECT_EQ(edges({0_b, 2, 1}, {1_b, 2, 0}),
            "bundle 1, layer 2, side 0: the two edges have different root edges");
  EXPECT_EQ(edges({0_b, 2, 1}, {0_b, 2, 1}),
            "bundle 0, layer 2, side 1: the two edges have different root edges");
  EXPECT_EQ(edges({0_b, 2, 1}, {1_b, 1, 3}),
            "bundle 1, layer 1, side 3: the two edges lie on different layers");
  EXPECT_EQ(edges({0_b, 1, 1}, {1_b, 1, 3}), "bundle 0, layer 1, side 1: the edge is joined already");
  const std::uint32_t a = corner(mesh, 0, 2, 1), b = corner(mesh, 1, 2, 0), c = corner(mesh, 1, 2, 1);
  EXPECT_NE(vertices(a, a).find("a vertex cannot be welded to itself"), std::string::npos);
  EXPECT_NE(vertices(a, c).find("the two vertices have different root vertices"), std::string::npos);
  EXPECT_NE(vertices(b, 0).find("the two vertices lie on different layers"), std::string::npos);
}

TEST(Divide, EdgeGivesOneVertexWhereSharedAndTwoWhereNot) {
  HairMesh mesh = block(2, 1, 2);
  ASSERT_TRUE(separateEdge(mesh, {0_b, 2, 1}).ok());
  const auto created = divideEdge(mesh, {0_b, 1, 1}, 0.25);
  ASSERT_TRUE(created.ok());
  EXPECT_EQ(created->vertices.size(), 4u);  // layers 0 and 1: one; layer 2: two
  EXPECT_EQ(mesh.bundles()[0].corners, 5u);
  EXPECT_EQ(mesh.bundles()[1].corners, 5u);
  EXPECT_EQ(mesh.position(corner(mesh, 0, 1, 2)), Vec3(1, 0.25, 1));
  EXPECT_EQ(corner(mesh, 0, 1, 2), corner(mesh, 1, 1, 4));
  EXPECT_NE(corner(mesh, 0, 2, 2), corner(mesh, 1, 2, 4));
  EXPECT_EQ(mesh.position(corner(mesh, 0, 2, 2)), mesh.position(corner(mesh, 1, 2, 4)));
  EXPECT_EQ(mesh.splits().size(), 2u);
  expectSound(mesh);
}

TEST(Divide, FaceByCornersAndBySides) {
  HairMesh mesh = block(1, 1, 1);
  mesh.setGroup(0, mesh.addGroup("fringe"));
  HairMesh sides = mesh;
  ASSERT_TRUE(divideFace(mesh, 0_b, 1, 3).ok());
  ASSERT_EQ(mesh.bundles().size(), 2u);
  EXPECT_EQ(mesh.bundles()[0].vertices, (std::vector<std::uint32_t>{0, 1, 2, 4, 5, 7}));
  EXPECT_EQ(mesh.bundles()[1].corners, 3u);
  EXPECT_EQ(mesh.bundles()[1].group, 1u);
  expectSound(mesh);
  ASSERT_TRUE(divideFace(sides, 0_b, FacePoint{0, 0.5}, FacePoint{2, 0.5}).ok());
  EXPECT_EQ(sides.vertices().size(), 12u);
  EXPECT_EQ(sides.bundles()[0].corners, 4u);
  EXPECT_EQ(sides.bundles()[1].corners, 4u);
  EXPECT_EQ(sides.position(corner(sides, 1, 1, 0)), Vec3(0.5, 0, 1));
  expectSound(sides);
}

TEST(Divide, Refuses) {
  const HairMesh mesh = block(2, 1, 1);
  const auto face = [&](FacePoint a, FacePoint b) {
    return refusal(mesh, [&](HairMesh& m) { return divideFace(m, 0_b, a, b); });
  };
  EXPECT_EQ(face({0}, {1}), "bundle 0: the two points are neighbours");
  EXPECT_EQ(face({3}, {0}), "bundle 0: the two points are neighbours");
  EXPECT_EQ(face({2}, {2}), "bundle 0: the two points are the same or lie on one side");
  EXPECT_EQ(face({0, 0.5}, {1}), "bundle 0: the two points are neighbours");
  EXPECT_EQ(face({0}, {4}), "bundle 0: the face has no such corner");
  EXPECT_EQ(face({0, 1}, {2}), "bundle 0: t must be 0 for a corner, or between 0 and 1 on a side");
  for (const double t : {0.0, 1.0, -0.5, 2.0, double(NAN)}) {
    EXPECT_EQ(refusal(mesh,
                      [&](HairMesh& m) {
                        return divideEdge(m, {0_b, 0, 1}, t);
                      }),
              "bundle 0, layer 0, side 1: t must lie between 0 and 1");
  }
  // Two quads around a vertex of two edges: both diagonals past it would be one edge of four faces.
  HairMesh pair = gridMesh(2, 1);
  ASSERT_TRUE(divideEdge(pair, {0_b, 0, 1}, 0.5).ok());
  ASSERT_TRUE(divideFace(pair, 0_b, 1, 3).ok());
  EXPECT_EQ(refusal(pair, [](HairMesh& m) { return divideFace(m, 1_b, 0, 3); }),
            "bundle 1: another root edge joins these corners already");
}

TEST(Dissolve, Refuses) {
  HairMesh mesh = block(2, 1, 1);
  const auto edge = [](const HairMesh& of, EdgeRef e) {
    return refusal(of, [&](HairMesh& m) { return dissolveEdge(m, e); });
  };
  const auto vertex = [](const HairMesh& of, VertexId v) {
    return refusal(of, [&](HairMesh& m) { return dissolveVertex(m, v); });
  };
  EXPECT_EQ(edge(mesh, {0_b, 0, 0}), "bundle 0, layer 0, side 0: the edge has one bundle only");
  EXPECT_EQ(vertex(mesh, 1_v), "vertex 1: the vertex has more than two root edges");
  EXPECT_EQ(vertex(mesh, 7_v), "vertex 7: the vertex is not on the root layer");
  HairMesh split = mesh, uneven = mesh, twice = mesh;
  ASSERT_TRUE(separateEdge(split, {0_b, 1, 1}).ok());
  EXPECT_EQ(edge(split, {0_b, 0, 1}), "bundle 0, layer 0, side 1: the edge is separated on a higher layer");
  ASSERT_TRUE(extrudeFaces(uneven, Ids{0_b}, {.distance = 1}).ok());
  EXPECT_EQ(edge(uneven, {0_b, 0, 1}), "bundle 0, layer 0, side 1: the two bundles have different heights");
  ASSERT_TRUE(divideEdge(twice, {0_b, 0, 1}).ok());
  EXPECT_EQ(edge(twice, {0_b, 0, 1}), "bundle 0, layer 0, side 1: the two bundles share more than this edge");
  ASSERT_TRUE(separateEdge(twice, {0_b, 1, 1}).ok());
  EXPECT_EQ(vertex(twice, twice.vertices()[corner(twice, 0, 0, 2)].id),
            "vertex 12: the two edges of the vertex are separated on different layers");
  HairMesh triangle = gridMesh(1, 1);
  ASSERT_TRUE(divideFace(triangle, 0_b, 0, 2).ok());
  EXPECT_EQ(vertex(triangle, 1_v), "vertex 1: a triangle would lose its third corner");
}

TEST(Subdivide, CatmullClarkHasTheClassicalWeightsOnEveryLayer) {
  HairMesh mesh = block(2, 2, 1);
  mesh.setPosition(corner(mesh, 0, 1, 2), {1, 1, 5});  // the middle of layer 1
  const auto created = subdivide(mesh, {});
  ASSERT_TRUE(created.ok());
  expectSound(mesh);
  EXPECT_EQ(mesh.bundles().size(), 16u);
  EXPECT_EQ(created->bundles.size(), 16u);
  EXPECT_EQ(mesh.vertices().size(), 2u * 25);
  // Child 2 of the first bundle holds its corner 2, the middle vertex of valence 4, first:
  // S' = 9/16 S + 6/16 mean of edge neighbours + 1/16 mean of diagonal neighbours; z: 1 all around, 5 in the
  // middle.
  const Vec3 middle = mesh.position(corner(mesh, 2, 1, 0));
  EXPECT_NEAR(middle.z(), 9.0 / 16 * 5 + 7.0 / 16, 1e-15);  // a rounding or two
  EXPECT_NEAR(mesh.position(corner(mesh, 2, 0, 0)).z(), 0, 0);
  // Face point: the mean of four corners. Edge point: 3/8 of its ends, 1/16 of the four others.
  EXPECT_NEAR(mesh.position(corner(mesh, 2, 1, 2)).z(), 2, 1e-15);
  EXPECT_NEAR(mesh.position(corner(mesh, 2, 1, 1)).z(), (3.0 / 8) * (5 + 1) + 4.0 / 16, 1e-15);
  // A corner of the outline stays.
  EXPECT_EQ(mesh.position(corner(mesh, 0, 0, 0)), Vec3(0, 0, 0));
}

TEST(Subdivide, NeighboursGetTheVerticesOnTheirEdges) {
  HairMesh mesh = block(3, 3, 2);
  mesh.setGroup(4, mesh.addGroup("crown"));
  ASSERT_TRUE(subdivide(mesh, Ids{4_b}).ok());
  expectSound(mesh);
  EXPECT_EQ(mesh.indexOf(4_b), kNone);
  EXPECT_EQ(mesh.bundles().size(), 12u);
  for (const std::uint32_t id : {1u, 3u, 5u, 7u}) {
    EXPECT_EQ(mesh.bundles()[mesh.indexOf(BundleId{id})].corners, 5u) << id;
  }
  EXPECT_EQ(mesh.bundles()[mesh.indexOf(0_b)].corners, 4u);
  EXPECT_EQ(mesh.bundles().back().group, 1u);
  EXPECT_TRUE(mesh.splits().empty());
  // One quad alone: its outline is all corners, so no old vertex moved.
  EXPECT_EQ(mesh.position(5), Vec3(1, 1, 0));
}

TEST(Subdivide, KeepsSplitsAndSlits) {
  HairMesh mesh = block(3, 3, 2);
  ASSERT_TRUE(separateEdge(mesh, {4_b, 1, 0}).ok());  // a slit from layer 1
  const std::uint32_t a = corner(mesh, 4, 1, 0);
  // Bent beside the slit: an edge shared by two faces would be pulled up, a boundary keeps to its middle.
  mesh.setPosition(corner(mesh, 4, 1, 3), {1, 2, 9});
  ASSERT_TRUE(subdivide(mesh, {}).ok());
  expectSound(mesh);
  EXPECT_EQ(mesh.splits().size(), 2u);  // the two halves
  EXPECT_EQ(mesh.vertices()[a].layer, 1u);
  std::size_t onSlit = 0;  // the middle of the slit: one vertex on layer 0, two on layers 1 and 2
  for (const HairVertex& vertex : mesh.vertices()) {
    onSlit += (vertex.position - Vec3(1.5, 1, vertex.layer)).norm() < 1e-12;
  }
  EXPECT_EQ(onSlit, 1u + 2 + 2);
}

TEST(Subdivide, ABowTieStaysWhereItIs) {
  HairMesh mesh = block(2, 2, 1);
  ASSERT_TRUE(separateEdge(mesh, {0_b, 1, 2}).ok());  // between bundles 0 and 2, then 1 and 3
  ASSERT_TRUE(separateEdge(mesh, {1_b, 1, 2}).ok());
  const VertexId a = mesh.vertices()[corner(mesh, 0, 1, 2)].id, b = mesh.vertices()[corner(mesh, 2, 1, 1)].id;
  ASSERT_TRUE(weldVertices(mesh, a, b).ok());
  const std::uint32_t middle = corner(mesh, 0, 1, 2);
  ASSERT_TRUE(mesh.vertices()[middle].welded);
  mesh.setPosition(middle, {1, 1, 5});
  const VertexId id = mesh.vertices()[middle].id;
  ASSERT_TRUE(subdivide(mesh, {}).ok());
  expectSound(mesh);
  EXPECT_EQ(mesh.position(mesh.indexOf(id)), Vec3(1, 1, 5));  // each fan alone would bring it to 4
}

TEST(Subdivide, LoopHasTheClassicalWeights) {
  // Six triangles around vertex 0.
  std::vector<Vec3> p{{0, 0, 7}};
  std::vector<std::uint32_t> offsets{0}, corners;
  for (std::uint32_t i = 0; i < 6; ++i) {
    p.emplace_back(std::cos(i * M_PI / 3), std::sin(i * M_PI / 3), 0);
    corners.insert(corners.end(), {0, 1 + i, 1 + (i + 1) % 6});
    offsets.push_back(std::uint32_t(corners.size()));
  }
  HairMesh mesh = HairMesh::fromRoot(p, offsets, corners).value();
  ASSERT_TRUE(subdivide(mesh, {}, SubdivisionScheme::Loop).ok());
  expectSound(mesh);
  EXPECT_EQ(mesh.bundles().size(), 24u);
  EXPECT_EQ(mesh.vertices().size(), 7u + 12);
  // Valence 6: 5/8 of itself and 1/16 of each neighbour; OpenSubdiv evaluates the mask in double.
  EXPECT_NEAR(mesh.position(0).z(), 7 * 5.0 / 8, 1e-14);
  EXPECT_NEAR(mesh.position(corner(mesh, 0, 0, 1)).z(), 7 * 3.0 / 8, 1e-14);
}

TEST(Subdivide, LoopRefusesWhatIsNoTriangle) {
  HairMesh mesh = block(2, 1, 1);
  ASSERT_TRUE(divideFace(mesh, 0_b, 0, 2).ok());
  const auto loop = [&](Ids ids) {
    return refusal(mesh, [&](HairMesh& m) { return subdivide(m, ids, SubdivisionScheme::Loop); });
  };
  EXPECT_EQ(loop({0_b, 1_b}), "bundle 1: Loop subdivision needs triangles");
  EXPECT_EQ(loop({9_b}), "bundle 9: the mesh has no such bundle");
}

}  // namespace
}  // namespace coif
