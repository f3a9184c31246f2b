// Topological operations on a hair mesh.
//
// Each keeps every invariant (invariants.h) or returns an Error that names the element, and then the mesh is
// unchanged. Ids are given, not indices: indices change when elements come or go. New vertices and bundles
// get new ids; new vertices and bundles inherit the pinned flag and the group of what they come from. On
// every layer above a separation the mesh is separated, on every layer below a weld it is welded, so that
// every vertex has one parent. Cost: linear in the mesh, below 1 ms for 200 bundles of five layers. Source:
// Yuksel, Schaefer, Keyser 2009, section 3.2; what the paper leaves open is settled in docs/hairmesh.md.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "coif/hairmesh/hair_mesh.h"

namespace coif {

/// What an operation made or, where it says so, what it kept.
struct Created {
  std::vector<FaceRef> faces;
  std::vector<BundleId> bundles;
  std::vector<VertexId> vertices;  ///< ascending
};

struct ExtrudeOptions {
  /// Along the area-weighted normal of the extruded faces at the vertex.
  double distance = 0;
  /// Instead: every new vertex is displaced by this vector.
  std::optional<Vec3> direction = std::nullopt;
  /// Instead: one vector a vertex of the mesh, by index, added to the new vertex's parent.
  std::vector<Vec3> offsets = {};
};

/// A new layer face and prism on each bundle's tip. Faces extruded together from one layer share new vertices
/// through the edges that they share; no new vertex is shared with anything else. Returns the new faces, in
/// the order given, and vertices. Errors: NotFound; InvalidArgument for an empty or repeating selection, a
/// face that is no tip, values not finite, offsets of another length; Degenerate where there is neither a
/// normal nor a parent to follow.
Result<Created> extrudeFaces(HairMesh& mesh, std::span<const BundleId> bundles,
                             const ExtrudeOptions& options = {});
Result<Created> extrudeFaces(HairMesh& mesh, std::span<const FaceRef> tips,
                             const ExtrudeOptions& options = {});

/// Of a curve that both sides of a mirror plane follow, each its own image of it.
struct CurveSides {
  enum Side : std::uint8_t { Curve = 1, Image = 2, Both = 3 };
  Vec3 point = Vec3::Zero(), normal = Vec3::UnitX();  ///< of the plane; unit length
  std::vector<Side> of;  ///< by entry of the bundles; where Both meet, hair goes midway, so on the plane
};

/// How several layers follow each other from the tips.
struct ExtrudePath {
  std::uint32_t layers = 1;  ///< >= 1
  double length = 0;         ///< of the whole, scene units; with a curve: its own
  /// Each layer turns by the part `bend` (0 … 1) from the last one's direction towards this one, of any
  /// length: gravity. The first direction is the hair's own, on the root layer the normal.
  Vec3 towards = Vec3::Zero();
  double bend = 0;
  /// Instead: the tips are carried along this line as a whole and turned with it, without twist. It may begin
  /// anywhere.
  std::vector<Vec3> curve = {};
  std::optional<CurveSides> sides = {};  ///< with a curve; none: all along the curve itself
};

/// extrudeFaces() layer by layer along a path. Returns the last faces, in the order given, and all new
/// vertices. Errors: those of extrudeFaces; InvalidArgument for no layer, a bend outside 0 … 1, a curve of no
/// length.
Result<Created> extrudeAlong(HairMesh& mesh, std::span<const BundleId> bundles, const ExtrudePath& path);

/// Removes the tip face and last prism of each bundle; a bundle of height 0 goes with its root face. Where
/// the remaining faces of a vertex only touch there it is split, on the root layer always, above unless a
/// weld holds it. Returns the vertices that splitting made.
Result<Created> deleteFaces(HairMesh& mesh, std::span<const BundleId> bundles);
Result<Created> deleteFaces(HairMesh& mesh, std::span<const FaceRef> tips);

/// A new layer before layer face.layer (>= 1) for every bundle that shared vertices connect to the face on
/// that layer. New vertices lie on the parent–child lines at t in (0, 1); t = 0 is the layer below. Returns
/// the new faces and vertices.
Result<Created> insertLayer(HairMesh& mesh, FaceRef face, double t = 0.5);

/// Removes layer face.layer (>= 1) of every bundle that shared vertices connect to the face on that layer;
/// the vertices above get the parents of those removed. Where it is a bundle's tip, that is a face delete.
Result<Created> removeLayer(HairMesh& mesh, FaceRef face);

/// Separates a shared edge of layer >= 1 there and on every layer above. An end whose faces still hang
/// together around it, or that a weld holds, stays one vertex there (a slit). Returns the vertices that came.
Result<Created> separateEdge(HairMesh& mesh, EdgeRef edge);

/// Gives every face at a vertex of layer >= 1 a vertex of its own, there and on every layer above.
Result<Created> separateVertex(HairMesh& mesh, VertexId vertex);
Result<Created> separateVertex(HairMesh& mesh, FaceRef face, std::uint32_t corner);

enum class WeldPosition {
  Average,
  First
};  ///< where a welded vertex goes: the mean of the two, or the first's

/// Joins two sides of one root edge, separate on this layer, there and on every layer below.
/// Of two vertices the one with the lower id stays. Returns the vertices that stayed.
Result<Created> weldEdges(HairMesh& mesh, EdgeRef first, EdgeRef second,
                          WeldPosition where = WeldPosition::Average);

/// Joins two vertices of one layer with the same root ancestor, there and on every layer below. An edge whose
/// two sides met in different ones of the two and that now has both ends in common is joined as well. Several
/// fans of faces may then touch in the vertex: a declared bow-tie (HairVertex::welded).
Result<Created> weldVertices(HairMesh& mesh, VertexId first, VertexId second,
                             WeldPosition where = WeldPosition::Average);

/// A corner of a face (t = 0), or a point of the side that begins there (0 < t < 1).
struct FacePoint {
  std::uint32_t corner = 0;
  double t = 0;
};
/// Splits a face in two from one point of its outline to another, in the whole bundle; points on sides divide
/// these edges first (divideEdge). The bundle keeps its id and first corner; the other part is a new bundle.
/// Refuses points that are neighbours or the same, and corners that a root edge joins elsewhere.
Result<Created> divideFace(HairMesh& mesh, BundleId bundle, FacePoint from, FacePoint to);
inline Result<Created> divideFace(HairMesh& mesh, BundleId bundle, std::uint32_t cornerA,
                                  std::uint32_t cornerB) {
  return divideFace(mesh, bundle, FacePoint{cornerA, 0}, FacePoint{cornerB, 0});
}

/// Inserts a vertex at t in (0, 1) along a root edge and all its copies, in every bundle that has the edge.
/// One vertex a layer where the edge is shared, one a side where it is not. The layer of `edge` only serves
/// to name it.
Result<Created> divideEdge(HairMesh& mesh, EdgeRef edge, double t = 0.5);

/// The inverse of divideFace: merges the two bundles of a root edge that they share on every layer, heights
/// equal and no other corner in common. The lower id stays.
Result<Created> dissolveEdge(HairMesh& mesh, EdgeRef edge);

/// The inverse of divideEdge: removes a root vertex between just two root edges, and the column above it.
/// Refuses triangles, edges of different splits and ends that another root edge joins.
Result<Created> dissolveVertex(HairMesh& mesh, VertexId rootVertex);

enum class SubdivisionScheme { CatmullClark, Loop };
/// Refines bundles once, on every layer alike; all of them for an empty selection. The outline of the
/// selection is treated as a boundary whose corners stay; bundles beyond it get the new vertices on their
/// edges (T-vertices). Child i of a bundle holds its corner i; Loop adds the middle one last. All children
/// have new ids. Accuracy: OpenSubdiv's stencils in double. Refuses Loop on a bundle that is no triangle.
Result<Created> subdivide(HairMesh& mesh, std::span<const BundleId> bundles,
                          SubdivisionScheme scheme = SubdivisionScheme::CatmullClark);

}  // namespace coif
