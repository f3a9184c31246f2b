// When each face's first root comes: a dither over the faces that is itself blue noise.
#pragma once

#include <cstdint>
#include <vector>

#include "coif/hairmesh/hair_mesh.h"

namespace coif {

/// One number in [0, 1) a bundle. A face whose hash is below its neighbours' comes before them: the number is
/// the face's rank among the faces that share a root vertex with it, evenly distributed, and neighbours push
/// each other away. Twice over, so it depends on faces at most two steps off and on nothing else of the mesh.
std::vector<double> rootOffsets(const HairMesh& mesh, std::uint64_t seed);

}  // namespace coif
