// What is selected on a hair mesh, and how a selection grows, shrinks and turns into another kind.
//
// Ids, not indices, so that a selection survives operations; what no longer exists is dropped by keepValid().
#pragma once

#include <vector>

#include "coif/hairmesh/hair_mesh.h"

namespace coif {

/// Sorted, each element once. A side that two bundles share is named by the bundle of the lower id.
struct Selection {
  std::vector<VertexId> vertices;
  std::vector<EdgeRef> edges;
  std::vector<FaceRef> faces;

  bool empty() const { return vertices.empty() && edges.empty() && faces.empty(); }
  std::size_t size() const { return vertices.size() + edges.size() + faces.size(); }
  bool operator==(const Selection&) const = default;
};

/// What an empty selection is filled with, and what "all" means.
/// Bundles, layers and groups are selected as faces.
enum class SelectKind { Vertex, Edge, Face, Bundle, Layer, Group };

/// The one name of an edge: of the bundles that share it on its layer, the one with the lower id.
/// `edge` must exist.
EdgeRef canonicalEdge(const HairMesh& mesh, EdgeRef edge);

/// Sorts, removes doubles, names edges canonically and drops what the mesh does not have.
Selection keepValid(const HairMesh& mesh, Selection selection);

/// By index, ascending: the selected vertices, the ends of selected edges, the corners of selected faces.
std::vector<std::uint32_t> selectedVertices(const HairMesh& mesh, const Selection& selection);
/// Selected faces, and faces all of whose corners are selected vertices.
std::vector<FaceRef> selectedFaces(const HairMesh& mesh, const Selection& selection);
/// Selected edges, and edges both of whose ends are selected vertices.
std::vector<EdgeRef> selectedEdges(const HairMesh& mesh, const Selection& selection);
/// Bundles of selectedFaces(), ascending.
std::vector<BundleId> selectedBundles(const HairMesh& mesh, const Selection& selection);

/// Every element of a kind on the whole mesh, or on one layer.
Selection allOf(const HairMesh& mesh, SelectKind kind, std::uint32_t layer = kNone);
/// Every element of `kind` that is not selected.
Selection inverted(const HairMesh& mesh, const Selection& selection, SelectKind kind);
/// One step along the layer: vertices by edges, faces and edges by shared vertices.
Selection grown(const HairMesh& mesh, const Selection& selection);
/// The opposite: what has a neighbour of its kind that is not selected goes.
Selection shrunk(const HairMesh& mesh, const Selection& selection);
/// Everything that edges connect to it on its layer.
Selection linked(const HairMesh& mesh, const Selection& selection);
/// Its faces' whole bundles, layers or groups, all their faces; as it is for the other kinds.
Selection widened(const HairMesh& mesh, Selection selection, SelectKind kind);
/// The same elements on every layer: vertices become columns, faces and edges bundles' stacks.
Selection columns(const HairMesh& mesh, const Selection& selection);
/// Edges that go on straight across quads' corners from a side (an edge loop), or side by side across
/// opposite sides of quads (a ring). Both end at faces that are no quads and at the border.
std::vector<EdgeRef> edgeLoop(const HairMesh& mesh, EdgeRef start);
std::vector<EdgeRef> edgeRing(const HairMesh& mesh, EdgeRef start);

}  // namespace coif
