// The operations' one way to change a mesh's topology: edit a copy, then commit it or leave the mesh alone.
#pragma once

#include <string>
#include <vector>

#include "coif/hairmesh/hair_mesh.h"
#include "hairmesh/topology.h"

namespace coif {

/// While editing, a bundle with no vertices is a deleted one and vertices may be unused; commit() drops both.
/// New vertices and bundles are appended, so both stay ascending by id.
class HairMeshBuilder {
 public:
  static Result<HairMeshBuilder> from(const HairMesh& mesh);

  std::vector<HairVertex> vertices;
  std::vector<Bundle> bundles;
  hairmesh::Topology topology;  ///< root adjacency and splits; see retopologise()

  std::uint32_t layers(std::uint32_t bundle) const { return hairmesh::layerCountOf(bundles[bundle]); }
  std::uint32_t& at(std::uint32_t bundle, std::uint32_t layer, std::uint32_t corner) {
    return bundles[bundle].vertices[std::size_t(layer) * bundles[bundle].corners + corner];
  }
  /// The vertex at the corner that `side` names.
  std::uint32_t& at(std::uint32_t side, std::uint32_t layer) {
    return at(topology.bundleOf(side), layer, topology.cornerOf(side));
  }
  bool joined(std::uint32_t side, std::uint32_t layer) const { return topology.joined(bundles, side, layer); }

  std::uint32_t addVertex(const Vec3& position, std::uint32_t parent, std::uint32_t layer,
                          bool pinned = false);
  std::uint32_t addBundle(std::uint32_t corners, std::uint32_t group, std::vector<std::uint32_t> rows);

  enum class Welds {
    Yield,  ///< what falls apart on a layer falls apart on all layers above
    Hold,   ///< a weld above keeps the vertices below it together (but on the root layer)
  };
  /// Gives every fan at a root vertex that no longer hangs together on a layer >= fromLayer a vertex of its
  /// own; the fan of the lowest bundle keeps the old one. Welded vertices stay whole.
  void regroup(std::uint32_t rootVertex, std::uint32_t fromLayer, Welds welds);

  /// Splits by present layer-0 vertices: live bundles, layer <= the lower height; sorted.
  std::vector<EdgeSplit> splits() const;
  /// After root corners changed: adjacency anew, with these splits; deleted bundles go, so indices shift.
  Status retopologise(const std::vector<EdgeSplit>& splits);

  /// Drops what is unused, numbers densely, checks every invariant and replaces `mesh`. On error `mesh` is as
  /// it was.
  Status commit(HairMesh& mesh);

  /// A mesh of these parts, every invariant checked.
  static Result<HairMesh> assemble(std::vector<HairVertex> vertices, std::vector<Bundle> bundles,
                                   std::vector<EdgeSplit> splits, std::vector<std::string> groupNames,
                                   std::uint32_t nextVertexId, std::uint32_t nextBundleId);

  /// The same unchecked: for a state that was a mesh before (undo, redo).
  static HairMesh restore(std::vector<HairVertex> vertices, std::vector<Bundle> bundles,
                          std::vector<EdgeSplit> splits, std::vector<std::string> groupNames,
                          std::uint32_t nextVertexId, std::uint32_t nextBundleId);
  /// Moves the bundles out of a mesh that restore() is about to replace.
  static std::vector<Bundle> takeBundles(HairMesh& mesh) { return std::move(mesh.bundles_); }

 private:
  void compact();
  void clearSingleFanWelds();

  std::vector<std::string> groupNames_;
  std::uint32_t nextVertexId_ = 0, nextBundleId_ = 0;
  bool rootChanged_ = false;  // root faces, or which root vertices they have
};

namespace hairmesh {
inline std::string placeOf(VertexId id) {
  return "vertex " + std::to_string(std::uint32_t(id));
}
inline std::string placeOf(BundleId id) {
  return "bundle " + std::to_string(std::uint32_t(id));
}
}  // namespace hairmesh

}  // namespace coif
