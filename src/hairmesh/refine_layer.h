// One step of subdivision of one layer, by OpenSubdiv.
#pragma once

#include <utility>
#include <vector>

#include "coif/base/result.h"
#include "coif/base/vec.h"
#include "coif/hairmesh/operations.h"

namespace coif::hairmesh {

/// A manifold polygon mesh; its corners in face order. `creases`: edges that count as boundaries though two
/// faces share both their ends; `fixed`: vertices that stay.
struct LayerMesh {
  std::vector<Vec3> positions;
  std::vector<int> faceSizes, corners;
  std::vector<std::pair<int, int>> creases;
  std::vector<int> fixed;
};

struct RefinedLayer {
  std::vector<Vec3> vertices;  ///< new places of the old vertices
  std::vector<Vec3> sides;     ///< one a corner: the new vertex on the side that begins there
  std::vector<Vec3> faces;     ///< one a face; empty for Loop
};

Result<RefinedLayer> refineLayer(const LayerMesh& mesh, SubdivisionScheme scheme);

}  // namespace coif::hairmesh
