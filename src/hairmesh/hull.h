// The normals of the hair's outside where the side quads are at hand already.
#pragma once

#include "coif/hairmesh/hair_mesh.h"

namespace coif::hairmesh {

/// hullNormals() with the mesh's own sideQuads().
std::vector<Vec3> hullNormals(const HairMesh& mesh, std::span<const SideQuad> quads);

}  // namespace coif::hairmesh
