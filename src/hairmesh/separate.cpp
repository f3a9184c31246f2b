// Separate and weld, of edges and of vertices.
#include <algorithm>

#include "coif/hairmesh/operations.h"
#include "hairmesh/select.h"

namespace coif {
namespace {

using namespace hairmesh;
using Welds = HairMeshBuilder::Welds;

Result<std::uint32_t> selectVertex(const HairMesh& mesh, VertexId id) {
  const std::uint32_t v = mesh.indexOf(id);
  if (v == kNone) return makeError(ErrorCode::NotFound, "the mesh has no such vertex", placeOf(id));
  return v;
}

/// Ancestors of a vertex by layer, itself last.
std::vector<std::uint32_t> lineage(const HairMesh& mesh, std::uint32_t v) {
  std::vector<std::uint32_t> line;
  for (; v != kNone; v = mesh.vertices()[v].parent) line.push_back(v);
  std::reverse(line.begin(), line.end());
  return line;
}

/// Joins two vertices of a layer at one root vertex; the one with the lower id stays. The weld is declared
/// here; commit() withdraws it where the faces form one fan.
void merge(HairMeshBuilder& b, std::uint32_t root, std::uint32_t first, std::uint32_t second,
           WeldPosition where) {
  if (first == second) return;
  const std::uint32_t kept = std::min(first, second), gone = std::max(first, second);
  const std::uint32_t layer = b.vertices[kept].layer;
  const Vec3 mean = 0.5 * b.vertices[first].position + 0.5 * b.vertices[second].position;
  const Vec3 position = where == WeldPosition::Average ? mean : b.vertices[first].position;
  b.vertices[kept].position = position;
  b.vertices[kept].pinned = b.vertices[kept].pinned || b.vertices[gone].pinned;
  b.vertices[kept].welded = true;
  for (const std::uint32_t corner : b.topology.around(root)) {
    const std::uint32_t layers = b.layers(b.topology.bundleOf(corner));
    if (layer >= layers || b.at(corner, layer) != gone) continue;
    b.at(corner, layer) = kept;
    if (layer + 1 < layers) b.vertices[b.at(corner, layer + 1)].parent = kept;
  }
}

}  // namespace

Result<Created> separateEdge(HairMesh& mesh, EdgeRef edge) {
  COIF_ASSIGN(const std::uint32_t j, selectEdge(mesh, edge));
  if (edge.layer == 0) return refuse("an edge of the root layer cannot be separated", placeOf(edge));
  COIF_ASSIGN(HairMeshBuilder b, HairMeshBuilder::from(mesh));
  const std::uint32_t side = b.topology.side(j, edge.side);
  if (!b.joined(side, edge.layer)) return refuse("the edge is a boundary edge of its layer", placeOf(edge));
  b.topology.setSplit(side, edge.layer);
  b.regroup(b.at(side, 0), edge.layer, Welds::Yield);
  b.regroup(b.at(b.topology.next(side), 0), edge.layer, Welds::Yield);
  return commitCreated(b, mesh);
}

Result<Created> separateVertex(HairMesh& mesh, VertexId vertex) {
  COIF_ASSIGN(const std::uint32_t v, selectVertex(mesh, vertex));
  const std::uint32_t layer = mesh.vertices()[v].layer;
  if (layer == 0) return refuse("a vertex of the root layer cannot be separated", placeOf(vertex));
  COIF_ASSIGN(HairMeshBuilder b, HairMeshBuilder::from(mesh));
  const std::uint32_t root = lineage(mesh, v)[0];
  std::vector<std::uint32_t> corners;
  for (const std::uint32_t c : b.topology.around(root)) {
    if (layer < b.layers(b.topology.bundleOf(c)) && b.at(c, layer) == v) corners.push_back(c);
  }
  if (corners.size() < 2) return refuse("the vertex belongs to one face only", placeOf(vertex));
  std::vector<std::uint32_t> ends{root};
  for (const std::uint32_t c : corners) {
    if (b.joined(c, layer)) {
      b.topology.setSplit(c, layer);
      ends.push_back(b.at(b.topology.next(c), 0));
    }
    for (std::uint32_t k = layer; k < b.layers(b.topology.bundleOf(c)); ++k)
      b.vertices[b.at(c, k)].welded = false;
  }
  for (const std::uint32_t end : ends) b.regroup(end, layer, Welds::Yield);
  return commitCreated(b, mesh);
}

Result<Created> separateVertex(HairMesh& mesh, FaceRef face, std::uint32_t corner) {
  COIF_ASSIGN(const std::uint32_t j, selectEdge(mesh, {face.bundle, face.layer, corner}));
  return separateVertex(mesh, mesh.vertices()[mesh.bundles()[j].face(face.layer)[corner]].id);
}

Result<Created> weldEdges(HairMesh& mesh, EdgeRef first, EdgeRef second, WeldPosition where) {
  COIF_ASSIGN(const std::uint32_t j, selectEdge(mesh, first));
  COIF_ASSIGN(const std::uint32_t m, selectEdge(mesh, second));
  if (first.layer != second.layer) return refuse("the two edges lie on different layers", placeOf(second));
  COIF_ASSIGN(HairMeshBuilder b, HairMeshBuilder::from(mesh));
  const std::uint32_t side = b.topology.side(j, first.side), other = b.topology.side(m, second.side);
  if (b.topology.opposite(side) != other)
    return refuse("the two edges have different root edges", placeOf(second));
  if (b.joined(side, first.layer)) return refuse("the edge is joined already", placeOf(first));
  const std::uint32_t next = b.topology.next(side), otherNext = b.topology.next(other);
  const std::uint32_t start = b.at(side, 0), end = b.at(next, 0);
  Created created;
  for (std::uint32_t k = b.topology.split(side); k <= first.layer; ++k) {
    merge(b, start, b.at(side, k), b.at(otherNext, k), where);
    merge(b, end, b.at(next, k), b.at(other, k), where);
    created.vertices.insert(created.vertices.end(),
                            {b.vertices[b.at(side, k)].id, b.vertices[b.at(next, k)].id});
  }
  b.topology.setSplit(side, first.layer + 1);
  std::sort(created.vertices.begin(), created.vertices.end());
  return commitCreated(b, mesh, std::move(created));
}

Result<Created> weldVertices(HairMesh& mesh, VertexId first, VertexId second, WeldPosition where) {
  COIF_ASSIGN(const std::uint32_t x, selectVertex(mesh, first));
  COIF_ASSIGN(const std::uint32_t y, selectVertex(mesh, second));
  if (x == y) return refuse("a vertex cannot be welded to itself", placeOf(first));
  const auto lineX = lineage(mesh, x), lineY = lineage(mesh, y);
  if (lineX.size() != lineY.size())
    return refuse("the two vertices lie on different layers", placeOf(second));
  if (lineX[0] != lineY[0]) return refuse("the two vertices have different root vertices", placeOf(second));
  COIF_ASSIGN(HairMeshBuilder b, HairMeshBuilder::from(mesh));
  const auto around = b.topology.around(lineX[0]);
  Created created;
  for (std::uint32_t k = 1; k < lineX.size(); ++k) {
    if (lineX[k] == lineY[k]) continue;
    std::vector<std::uint32_t> candidates;  // edges that met in different ones of the two
    for (const std::uint32_t c : around) {
      if (b.topology.opposite(c) == kNone || b.topology.split(c) != k) continue;
      const std::uint32_t across = b.topology.next(b.topology.opposite(c));
      if (k >= b.layers(b.topology.bundleOf(c)) || k >= b.layers(b.topology.bundleOf(across))) continue;
      const std::uint32_t p = b.at(c, k), q = b.at(across, k);
      if (p != q && std::minmax(p, q) == std::minmax(lineX[k], lineY[k])) candidates.push_back(c);
    }
    merge(b, lineX[0], lineX[k], lineY[k], where);
    for (const std::uint32_t c : candidates) {
      if (b.at(b.topology.next(c), k) == b.at(b.topology.opposite(c), k)) b.topology.setSplit(c, k + 1);
    }
    created.vertices.push_back(mesh.vertices()[std::min(lineX[k], lineY[k])].id);
  }
  std::sort(created.vertices.begin(), created.vertices.end());
  return commitCreated(b, mesh, std::move(created));
}

}  // namespace coif
