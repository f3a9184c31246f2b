// Inserting vertices on root edges and all their copies: shared by edge divide, face divide and subdivision.
#pragma once

#include <functional>
#include <span>

#include "hairmesh/builder.h"

namespace coif::hairmesh {

/// Inserts one vertex in the column of each root edge, after the corner that begins the side, in every bundle
/// that has it. `sides`: one a root edge. position(side, layer) places the vertex of that side; it is asked
/// once a layer for a shared edge (of the side in `sides`) and once a side otherwise. The topology is
/// rebuilt.
Status divideSides(HairMeshBuilder& builder, std::span<const std::uint32_t> sides,
                   const std::function<Vec3(std::uint32_t side, std::uint32_t layer)>& position);

}  // namespace coif::hairmesh
