// The hair mesh: layers of polygons over a root layer, one column of faces (a bundle) a root face.
//
// Source: Yuksel, Schaefer, Keyser, "Hair Meshes", 2009, section 3; the corrections are listed in
// docs/hairmesh.md. Plain value: copy, compare and serialise it freely. Every operation keeps every invariant
// (invariants.h) or returns an Error and changes nothing.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "coif/base/result.h"
#include "coif/base/vec.h"

namespace coif {

/// Persistent names: never reused in one mesh's history, kept by undo and by files.
enum class VertexId : std::uint32_t {};
enum class BundleId : std::uint32_t {};

struct HairVertex {
  VertexId id{};
  Vec3 position = Vec3::Zero();
  std::uint32_t parent = kNone;  ///< index of the parent vertex, one layer down; kNone on layer 0
  std::uint32_t layer = 0;
  bool pinned = false;  ///< the artist's wish: treat as external
  bool welded = false;  ///< a declared bow-tie: a vertex weld holds several fans of faces together here
  bool operator==(const HairVertex&) const = default;
};

/// One column of faces. Corner i of layer k+1 has corner i of layer k as its parent.
struct Bundle {
  BundleId id{};
  std::uint32_t corners = 0;            ///< same on every layer, >= 3
  std::uint32_t group = 0;              ///< index into HairMesh::groupNames()
  std::vector<std::uint32_t> vertices;  ///< (height + 1) × corners vertex indices, row-major

  std::uint32_t height() const { return std::uint32_t(vertices.size()) / corners - 1; }  ///< n_j
  std::span<const std::uint32_t> face(std::uint32_t layer) const {
    return std::span(vertices).subspan(std::size_t(layer) * corners, corners);
  }
  bool operator==(const Bundle&) const = default;
};

/// A root edge whose two bundles no longer share it from `layer` upwards. `a` < `b` are layer-0 vertex
/// indices.
struct EdgeSplit {
  std::uint32_t a = 0, b = 0, layer = 0;
  auto operator<=>(const EdgeSplit&) const = default;
};

/// A face of the mesh, and an edge of it: side i runs from corner i to corner i + 1.
struct FaceRef {
  BundleId bundle{};
  std::uint32_t layer = 0;
  auto operator<=>(const FaceRef&) const = default;
};
struct EdgeRef {
  BundleId bundle{};
  std::uint32_t layer = 0;
  std::uint32_t side = 0;
  auto operator<=>(const EdgeRef&) const = default;
};

class HairMesh {
 public:
  HairMesh() = default;

  /// The root layer alone (every height 0). positions: V×3; face f has corners [offsets[f], offsets[f+1]) of
  /// `corners`. Vertices that no face uses are dropped; a vertex whose faces only touch there (a bow-tie) is
  /// split. Errors: Degenerate for an edge of three or more faces, or two faces that run along an edge the
  /// same way; InvalidArgument for indices out of range, faces of fewer than three corners or with a vertex
  /// twice, values not finite.
  static Result<HairMesh> fromRoot(std::span<const Vec3> positions, std::span<const std::uint32_t> offsets,
                                   std::span<const std::uint32_t> corners);

  /// Rebuilds a mesh from stored arrays (a file, another language), checking every invariant.
  static Result<HairMesh> fromParts(std::vector<HairVertex> vertices, std::vector<Bundle> bundles,
                                    std::vector<EdgeSplit> splits, std::vector<std::string> groupNames,
                                    std::uint32_t nextVertexId, std::uint32_t nextBundleId);

  // Reading. Vertices ascend by id, bundles ascend by id; indices are dense and change when elements come or
  // go.
  std::span<const HairVertex> vertices() const { return vertices_; }
  std::span<const Bundle> bundles() const { return bundles_; }
  std::span<const EdgeSplit> splits() const { return splits_; }
  std::span<const std::string> groupNames() const { return groupNames_; }
  std::uint32_t nextVertexId() const { return nextVertexId_; }
  std::uint32_t nextBundleId() const { return nextBundleId_; }
  std::uint32_t layerCount() const;          ///< 1 + the greatest height; 0 when empty
  std::uint32_t indexOf(VertexId id) const;  ///< kNone when there is none
  std::uint32_t indexOf(BundleId id) const;  ///< kNone when there is none
  const Vec3& position(std::uint32_t vertex) const { return vertices_[vertex].position; }

  // Geometry. Sizes and indices are preconditions (checked).
  void setPosition(std::uint32_t vertex, const Vec3& position) { vertices_.at(vertex).position = position; }
  void setPinned(std::uint32_t vertex, bool pinned) { vertices_.at(vertex).pinned = pinned; }
  std::uint32_t addGroup(const std::string& name);  ///< index of the group of that name, made if new
  void setGroup(std::uint32_t bundle, std::uint32_t group) { bundles_.at(bundle).group = group; }

  bool operator==(const HairMesh&) const = default;

 private:
  friend class HairMeshBuilder;  // src/hairmesh: the operations' one way to change topology
  std::vector<HairVertex> vertices_;
  std::vector<Bundle> bundles_;
  std::vector<EdgeSplit> splits_;  // sorted; only entries below the lower of the two bundles' heights + 1
  std::vector<std::string> groupNames_{"hair"};
  std::uint32_t nextVertexId_ = 0;
  std::uint32_t nextBundleId_ = 0;
};

/// Which vertices the artist places (spec section 1), as flags by vertex index.
/// External: on layer 0, on a tip face, on an exposed side quad, on a boundary edge of its layer, or pinned.
std::vector<std::uint8_t> externalVertices(const HairMesh& mesh);

/// The quad between edge (a, b) of a layer and its child edge (c, d): a→b below, c over a, d over b.
struct SideQuad {
  std::uint32_t a = 0, b = 0, c = 0, d = 0;  ///< vertex indices
  bool exposed = false;                      ///< one bundle uses it, not two
};
/// Every side quad once, ordered by (bundle, layer, side) of its first use.
std::vector<SideQuad> sideQuads(const HairMesh& mesh);

}  // namespace coif
