// Layer insert and layer remove.
#include <algorithm>

#include "coif/hairmesh/operations.h"
#include "hairmesh/select.h"

namespace coif {
namespace {

using namespace hairmesh;

/// Bundles that shared vertices connect to `start` on a layer, as flags.
std::vector<std::uint8_t> connectedAt(const HairMesh& mesh, std::uint32_t start, std::uint32_t layer) {
  const auto bundles = mesh.bundles();
  SmallSets sets;
  sets.reset(bundles.size());
  std::vector<std::uint32_t> owner(mesh.vertices().size(), kNone);
  for (std::uint32_t j = 0; j < bundles.size(); ++j) {
    if (bundles[j].height() < layer) continue;
    for (const std::uint32_t v : bundles[j].face(layer)) {
      if (owner[v] == kNone) owner[v] = j;
      sets.unite(owner[v], j);
    }
  }
  std::vector<std::uint8_t> connected(bundles.size(), 0);
  for (std::uint32_t j = 0; j < bundles.size(); ++j) connected[j] = sets.find(j) == sets.find(start);
  return connected;
}

/// Moves the layer numbers of vertices and splits of the connected bundles from `first` upwards by one.
void shiftLayers(HairMeshBuilder& b, const std::vector<std::uint8_t>& connected, std::uint32_t first,
                 int by) {
  std::vector<std::uint8_t> moves(b.vertices.size(), 0);
  for (std::uint32_t j = 0; j < b.bundles.size(); ++j) {
    if (!connected[j]) continue;
    const auto& rows = b.bundles[j].vertices;
    for (std::size_t c = std::size_t(first) * b.bundles[j].corners; c < rows.size(); ++c) moves[rows[c]] = 1;
  }
  for (std::size_t v = 0; v < moves.size(); ++v) b.vertices[v].layer += moves[v] ? std::uint32_t(by) : 0;
  for (std::uint32_t side = 0; side < b.topology.sideCount(); ++side) {
    const std::uint32_t other = b.topology.opposite(side), split = b.topology.split(side);
    if (other == kNone || other < side || split == kNone || split < first) continue;
    if (!connected[b.topology.bundleOf(side)] || !connected[b.topology.bundleOf(other)]) continue;
    b.topology.setSplit(side, split + std::uint32_t(by));
  }
}

Result<std::uint32_t> selectLayer(const HairMesh& mesh, FaceRef face) {
  COIF_ASSIGN(const std::uint32_t j, selectFace(mesh, face));
  if (face.layer == 0)
    return refuse("the root layer can neither be inserted before nor removed", placeOf(face));
  return j;
}

}  // namespace

Result<Created> insertLayer(HairMesh& mesh, FaceRef face, double t) {
  COIF_ASSIGN(const std::uint32_t start, selectLayer(mesh, face));
  if (!(t > 0 && t < 1)) return refuse("t must lie between 0 and 1", placeOf(face));
  COIF_ASSIGN(HairMeshBuilder b, HairMeshBuilder::from(mesh));
  const std::uint32_t k = face.layer;
  const auto connected = connectedAt(mesh, start, k);
  // A split at k itself stays: the new layer has the topology of the one it comes before.
  shiftLayers(b, connected, k + 1, 1);
  std::vector<std::uint32_t> below(b.vertices.size(), kNone);  // old vertex of layer k → its new parent
  Created created;
  for (std::uint32_t j = 0; j < b.bundles.size(); ++j) {
    if (!connected[j]) continue;
    Bundle& bundle = b.bundles[j];
    std::vector<std::uint32_t> row;
    for (const std::uint32_t v : bundle.face(k)) {
      if (below[v] == kNone) {
        const HairVertex child = b.vertices[v];
        const HairVertex& parent = b.vertices[child.parent];
        below[v] = b.addVertex(parent.position + t * (child.position - parent.position), child.parent, k,
                               parent.pinned && child.pinned);
        b.vertices[below[v]].welded = child.welded;
        b.vertices[v].parent = below[v];
        b.vertices[v].layer = k + 1;
      }
      row.push_back(below[v]);
    }
    bundle.vertices.insert(bundle.vertices.begin() + std::ptrdiff_t(k) * bundle.corners, row.begin(),
                           row.end());
    created.faces.push_back({bundle.id, k});
  }
  return commitCreated(b, mesh, std::move(created));
}

Result<Created> removeLayer(HairMesh& mesh, FaceRef face) {
  COIF_ASSIGN(const std::uint32_t start, selectLayer(mesh, face));
  COIF_ASSIGN(HairMeshBuilder b, HairMeshBuilder::from(mesh));
  const std::uint32_t k = face.layer;
  const auto connected = connectedAt(mesh, start, k);
  shiftLayers(b, connected, k + 1, -1);
  std::vector<std::uint8_t> adopted(b.vertices.size(), 0);
  for (std::uint32_t j = 0; j < b.bundles.size(); ++j) {
    if (!connected[j]) continue;
    Bundle& bundle = b.bundles[j];
    if (bundle.height() > k) {
      for (const std::uint32_t v : bundle.face(k + 1)) {
        if (!adopted[v]++) b.vertices[v].parent = b.vertices[b.vertices[v].parent].parent;
      }
    }
    const auto row = bundle.vertices.begin() + std::ptrdiff_t(k) * bundle.corners;
    bundle.vertices.erase(row, row + bundle.corners);
  }
  return commitCreated(b, mesh);
}

}  // namespace coif
