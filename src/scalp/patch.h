// A disc of triangles cut out of a surface, and its map to the unit disc.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "coif/scalp/region.h"
#include "coif/scalp/surface.h"

namespace coif {

/// P vertices, T triangles, one boundary loop. Every triangle lies in one triangle of the surface, but for
/// the lids over holes (parent kNone).
struct Patch {
  using Triangle = std::array<std::uint32_t, 3>;
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> parents;             ///< T
  std::vector<std::array<Vec3, 3>> barycentrics;  ///< T: of the corners, in the parent
  std::vector<std::uint32_t> boundary;  ///< loop of vertices, the patch to its left seen from outside
  std::vector<std::uint32_t> middle;    ///< vertices along the mirror plane, edge to edge; or empty
  std::vector<std::string> notes;

  double area(std::size_t t) const;
};

/// A place in a patch.
struct PatchPoint {
  std::uint32_t triangle = kNone;
  Vec3 barycentric = Vec3::Zero();
};

struct PatchOptions {
  bool wholeFaces = false;            ///< do not cut through faces
  std::optional<MirrorPlane> mirror;  ///< cut along it as well, so that it is a path of edges
};
/// Errors as in cage.h.
Result<Patch> cutPatch(const Surface& surface, const Region& region, const PatchOptions& options);

/// Closes small holes, orders the boundary, checks that the patch is a disc. (Used by cutPatch.)
Status makeDisc(Patch& patch);

/// Positions of the patch's vertices in the unit disc: u to the right, v to the back, the boundary by arc
/// length with `front` at (0, −1) and `back` at (0, 1) (positions in the boundary loop), the middle path on u
/// = 0.
struct DiscMap {
  std::vector<Vec2> uv;     ///< P
  std::uint32_t flips = 0;  ///< triangles that are folded or flat
};
/// Tutte's theorem: any positive weights give a map without folds; cotangent weights are raised to be
/// positive, and where rounding folds it all the same uniform weights are tried. Cost: one sparse
/// factorisation.
DiscMap mapToDisc(const Patch& patch, std::uint32_t front, std::uint32_t back);

}  // namespace coif
