// Geometric editing of a hair mesh: selections, moves with soft falloff, smoothing, mirror symmetry.
//
// Nothing here changes topology or places internal vertices (place.h does). Vertices and bundles are given by
// index, as the mesh has them now; lists ascend. Indices out of range and values not finite are errors, and
// then the mesh is unchanged. Cost: linear in the mesh unless stated.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "coif/hairmesh/hair_mesh.h"

namespace coif {

/// A weight in [0, 1] for each vertex of the mesh, by index.
using VertexWeights = std::vector<double>;

// Selections.
std::vector<std::uint32_t> verticesOfLayer(const HairMesh& mesh, std::uint32_t layer);
/// Vertices of a bundle's faces; of one layer when `layer` is not kNone.
Result<std::vector<std::uint32_t>> verticesOfBundle(const HairMesh& mesh, BundleId bundle,
                                                    std::uint32_t layer = kNone);
/// A vertex, its ancestors down to the root and all its descendants.
Result<std::vector<std::uint32_t>> columnOf(const HairMesh& mesh, std::uint32_t vertex);
/// Bundles that shared edges connect to `bundle` on `layer`, by index.
Result<std::vector<std::uint32_t>> connectedBundles(const HairMesh& mesh, BundleId bundle,
                                                    std::uint32_t layer = 0);
/// A strip of quads on the root layer: from a side across opposite sides both ways, until a face that is no
/// quad, the border, or the start again. Bundles by index, in strip order.
Result<std::vector<std::uint32_t>> quadStrip(const HairMesh& mesh, EdgeRef side);

/// How a weight falls from 1 at the centre to 0 at the rim.
enum class Falloff {
  Smooth,    ///< 3s² − 2s³, s the part of the radius that is left
  Linear,    ///< s
  Sharp,     ///< s²
  Round,     ///< √(2s − s²), a half circle
  Constant,  ///< 1 up to the rim
};
/// At `distance` from the centre over the radius, >= 0.
double falloffAt(Falloff falloff, double distance);

/// What a soft selection's distance is.
enum class SoftDistance {
  Space,    ///< as the crow flies
  Surface,  ///< along the faces of the layers and the sides of the bundles (geodesic.h), exact where they are
            ///< flat; what no edge connects is out of reach
};

/// 1 on the selection, falling to 0 at `radius` from the nearest selected vertex; radius 0: the selection
/// alone. Cost: selection × mesh in space, n log n along the surface.
Result<VertexWeights> softSelection(const HairMesh& mesh, std::span<const std::uint32_t> selection,
                                    double radius = 0, Falloff falloff = Falloff::Smooth,
                                    SoftDistance distance = SoftDistance::Space);

/// Unit normals of the hair's outside by vertex index: area-weighted over exposed side quads, or over tip
/// faces where a vertex has none; zero for vertices inside.
std::vector<Vec3> hullNormals(const HairMesh& mesh);

/// Which way the axes of a selection point.
enum class AxesKind {
  World,   ///< the scene's own
  Hair,    ///< y along the hair, root to tip; z as near to the outside's normal as that leaves
  Normal,  ///< z along the mean normal of the hair's outside; y as near to the hair as that leaves
};
/// Three unit axes at right angles, as columns, right-handed: means over these vertices. A direction that the
/// hair there does not have (no link, no outside) is taken from the scene's axes.
Mat3 selectionAxes(const HairMesh& mesh, std::span<const std::uint32_t> vertices, AxesKind kind);

// Moves. A vertex of weight w goes the fraction w of the way.
Status translate(HairMesh& mesh, const VertexWeights& weights, const Vec3& by);
/// By the factors along the columns of `axes`. Errors: InvalidArgument where those are not orthonormal to
/// 1e-6.
Status scale(HairMesh& mesh, const VertexWeights& weights, const Vec3& pivot, const Vec3& factors,
             const Mat3& axes = Mat3::Identity());
/// By w times the angle, about the axis (any length > 0) through the pivot, right-handed.
Status rotate(HairMesh& mesh, const VertexWeights& weights, const Vec3& pivot, const Vec3& axis,
              double angleRad);
/// Laplacian steps within each layer: a vertex goes `strength` in [0, 1] times its weight towards the mean of
/// its edge neighbours. A vertex at the end of a boundary edge only looks at boundary edges.
Status smooth(HairMesh& mesh, const VertexWeights& weights, double strength = 0.5, int steps = 1);

/// Which elements are each other's image in a mirror plane; found on the root layer by position, above by
/// topology.
struct Mirror {
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitX();  ///< unit length
  std::vector<std::uint32_t>
      vertexPartner;  ///< by vertex index; itself on the plane, kNone without a partner
  std::vector<std::uint32_t> bundlePartner;  ///< by bundle index; itself when it crosses the plane
  std::vector<std::uint32_t> cornerPartner;  ///< by bundle: the partner's corner that corner 0 maps to; the
                                             ///< corners then run backwards
  Vec3 image(const Vec3& p) const { return p - 2 * (p - point).dot(normal) * normal; }
  bool complete() const;  ///< has every vertex and bundle a partner?
};

/// Root vertices are partners when each is the nearest to the other's image within `tolerance` (scene units);
/// bundles when their root corners are partners in opposite order; higher vertices when all their corners
/// agree. Errors: InvalidArgument for a normal of no length or a tolerance not > 0.
Result<Mirror> findMirror(const HairMesh& mesh, const Vec3& point, const Vec3& normal, double tolerance);

/// The same face or edge on the other side; NotFound when it has no partner.
Result<FaceRef> mirrored(const HairMesh& mesh, const Mirror& mirror, FaceRef face);
Result<EdgeRef> mirrored(const HairMesh& mesh, const Mirror& mirror, EdgeRef edge);
/// A selection and its mirror image, each bundle once: what a symmetric extrude, delete or subdivide is
/// given.
Result<std::vector<BundleId>> withMirrored(const HairMesh& mesh, const Mirror& mirror,
                                           std::span<const BundleId> ids);

/// Moves vertices by displacements (one a vertex) and their partners by the mirrored ones; vertices on the
/// plane stay on it. Where both of a pair are displaced, each side moves by the sum of its own and the
/// other's image.
Status moveSymmetrically(HairMesh& mesh, const Mirror& mirror, std::span<const Vec3> displacements);

/// Puts every vertex whose root ancestor is behind the plane (the side the normal leaves) at its partner's
/// image, and vertices that are their own partners on the plane. Returns the number of vertices without a
/// partner, left alone.
Result<std::size_t> symmetrise(HairMesh& mesh, const Mirror& mirror);

/// Where the partner of `ref` is once the operation on `ref` has turned `before` into `after`; empty when
/// that operation took it along: the same face or edge, or a face whose bundle changed height with the
/// other's layer.
Result<std::optional<FaceRef>> partnerAfter(const HairMesh& before, const HairMesh& after,
                                            const Mirror& mirror, FaceRef ref);
Result<std::optional<EdgeRef>> partnerAfter(const HairMesh& before, const HairMesh& after,
                                            const Mirror& mirror, EdgeRef ref);

/// Applies a topological operation to an edge or face and to its partner, or to neither: operation(mesh, ref)
/// returns a Result. What the first takes along (an edge on the plane, a layer of a connected mesh) is done
/// once.
template <class Ref, class Operation>
Status applySymmetrically(HairMesh& mesh, const Mirror& mirror, Ref ref, Operation&& operation) {
  HairMesh copy = mesh;
  if (const auto partner = mirrored(mesh, mirror, ref); !partner.ok()) return partner.error();
  if (const auto first = operation(copy, ref); !first.ok()) return first.error();
  COIF_ASSIGN(const std::optional<Ref> partner, partnerAfter(mesh, copy, mirror, ref));
  if (partner) {
    if (const auto second = operation(copy, *partner); !second.ok()) return second.error();
  }
  mesh = std::move(copy);
  return {};
}

}  // namespace coif
