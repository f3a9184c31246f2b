// An independent minimiser: dense Gauss elimination in long double on the normal equations assembled from the
// bundles, not from sideQuads. For a few hundred unknowns.
#pragma once

#include "coif/hairmesh/hair_mesh.h"

namespace coif::placetest {

/// Minimising positions of all vertices. Requires that no component is free.
std::vector<Vec3> referencePositions(const HairMesh& mesh);

/// max distance between the positions of two meshes / bounding-box diagonal of the first.
double distance(const HairMesh& a, const HairMesh& b);
double diagonal(const HairMesh& mesh);

}  // namespace coif::placetest
