// separate∘weld, insert∘remove, extrude∘delete, divide∘dissolve give back the same mesh, on meshes of random
// walks.
#include "hairmesh/random_operations.h"
#include "hairmesh/test_meshes.h"

namespace coif {
namespace {

/// Equal but for the counters of ids, which never go back.
void expectSame(const HairMesh& a, const HairMesh& b, const char* law) {
  EXPECT_TRUE(std::ranges::equal(a.vertices(), b.vertices())) << law;
  EXPECT_TRUE(std::ranges::equal(a.bundles(), b.bundles())) << law;
  EXPECT_TRUE(std::ranges::equal(a.splits(), b.splits())) << law;
}

bool extrudeDelete(const HairMesh& mesh, Draw& draw) {
  HairMesh copy = mesh;
  const auto ids = patch(mesh, draw, 1 + draw.below(20));
  if (!extrudeFaces(copy, ids, {.direction = Vec3(0.1, 0.2, 0.3)}).ok()) return false;
  EXPECT_TRUE(deleteFaces(copy, ids).ok());
  expectSame(copy, mesh, "extrude, delete");
  return true;
}

bool insertRemove(const HairMesh& mesh, Draw& draw) {
  HairMesh copy = mesh;
  const FaceRef face = anyUpperFace(mesh, draw);
  if (!insertLayer(copy, face, draw.inside()).ok()) return false;
  EXPECT_TRUE(removeLayer(copy, face).ok());
  expectSame(copy, mesh, "insert, remove");
  return true;
}

bool divideDissolveEdge(const HairMesh& mesh, Draw& draw) {
  HairMesh copy = mesh;
  const auto created = divideEdge(copy, anyEdge(mesh, draw), draw.inside());
  EXPECT_TRUE(created.ok());
  EXPECT_TRUE(dissolveVertex(copy, created->vertices[0]).ok());
  expectSame(copy, mesh, "divide edge, dissolve vertex");
  return true;
}

bool divideDissolveFace(const HairMesh& mesh, Draw& draw) {
  HairMesh copy = mesh;
  const Bundle& bundle = mesh.bundles()[draw.below(mesh.bundles().size())];
  const std::uint32_t a = draw.below(bundle.corners), b = draw.below(bundle.corners);
  if (!divideFace(copy, bundle.id, a, b).ok()) return false;
  EXPECT_TRUE(dissolveEdge(copy, {bundle.id, 0, std::min(a, b)}).ok());
  expectSame(copy, mesh, "divide face, dissolve edge");
  return true;
}

std::uint32_t rootOf(const HairMesh& mesh, std::uint32_t v) {
  while (mesh.vertices()[v].parent != kNone) v = mesh.vertices()[v].parent;
  return v;
}

/// Every other vertex over these two root vertices is free of welds: a weld that a separation tore apart
/// beside the edge is not the edge's to mend.
bool hasWeldOver(const HairMesh& mesh, std::uint32_t a, std::uint32_t b) {
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
    if (mesh.vertices()[v].welded && (rootOf(mesh, v) == a || rootOf(mesh, v) == b)) return true;
  }
  return false;
}

bool separateWeldEdge(const HairMesh& mesh, Draw& draw) {
  const EdgeRef edge = anySharedEdge(mesh, draw, true);
  const Bundle& bundle = mesh.bundles()[mesh.indexOf(edge.bundle)];
  const std::uint32_t a = bundle.face(0)[edge.side], b = bundle.face(0)[(edge.side + 1) % bundle.corners];
  if (hasWeldOver(mesh, a, b)) return false;
  HairMesh copy = mesh;
  if (!separateEdge(copy, edge).ok()) return false;
  EdgeRef other{};
  std::uint32_t top = bundle.height();  // the last layer on which the edge was shared
  for (const Bundle& candidate : mesh.bundles()) {
    for (std::uint32_t i = 0; i < candidate.corners; ++i) {
      if (candidate.face(0)[i] != b || candidate.face(0)[(i + 1) % candidate.corners] != a) continue;
      other = {candidate.id, 0, i};
      top = std::min(top, candidate.height());
    }
  }
  for (const EdgeSplit& split : mesh.splits()) {
    if (split.a == std::min(a, b) && split.b == std::max(a, b)) top = split.layer - 1;
  }
  other.layer = top;
  EXPECT_NE(copy, mesh);
  EXPECT_TRUE(weldEdges(copy, {edge.bundle, top, edge.side}, other).ok());
  expectSame(copy, mesh, "separate edge, weld edges");
  return true;
}

bool separateWeldVertex(const HairMesh& mesh, Draw& draw) {
  const std::uint32_t v = draw.below(mesh.vertices().size()), layer = mesh.vertices()[v].layer,
                      root = rootOf(mesh, v);
  std::size_t faces = 0;
  for (const Bundle& bundle : mesh.bundles()) {
    if (bundle.height() < layer || std::ranges::find(bundle.face(layer), v) == bundle.face(layer).end())
      continue;
    if (bundle.height() > layer) return false;  // vertices above would have to be welded as well
    ++faces;
  }
  // An edge that was a slit before is joined by the weld: not the inverse then.
  const auto touches = [&](const EdgeSplit& split) { return split.a == root || split.b == root; };
  if (std::ranges::any_of(mesh.splits(), touches)) return false;
  HairMesh copy = mesh;
  const auto created = separateVertex(copy, mesh.vertices()[v].id);
  if (!created.ok() || created->vertices.size() != faces - 1) return false;  // the far ends came apart too
  for (const VertexId id : created->vertices) EXPECT_TRUE(weldVertices(copy, mesh.vertices()[v].id, id).ok());
  expectSame(copy, mesh, "separate vertex, weld vertices");
  return true;
}

TEST(InverseLaws, HoldOnMeshesOfRandomWalks) {
  struct Law {
    const char* name;
    bool (*test)(const HairMesh&, Draw&);
    int tested = 0;
  };
  Law laws[] = {{"extrude, delete", extrudeDelete},  {"insert, remove", insertRemove},
                {"divide edge", divideDissolveEdge}, {"divide face", divideDissolveFace},
                {"separate edge", separateWeldEdge}, {"separate vertex", separateWeldVertex}};
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    HairMesh mesh = capMesh(8);
    Draw draw(seed);
    for (int i = 0; i < 700; ++i) {
      (void)randomOperation(mesh, chooseKind(mesh, draw, 128, 256), draw, 0.05);
      for (Law& law : laws) {
        bool applied = false;  // the vertex law asks for much: try some places
        for (int attempt = 0; attempt < 10 && !applied; ++attempt) applied = law.test(mesh, draw);
        law.tested += applied;
      }
      if (testing::Test::HasFailure()) FAIL() << "seed " << seed << ", step " << i;
    }
  }
  for (const Law& law : laws) EXPECT_GT(law.tested, 100) << law.name;
}

}  // namespace
}  // namespace coif
