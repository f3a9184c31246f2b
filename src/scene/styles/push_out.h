// Keeps strands out of the head, not only vertices: between columns on a round head a strand runs along the
// chord.
#pragma once

#include <vector>

#include "coif/base/context.h"
#include "coif/hairmesh/hair_mesh.h"
#include "scene/styles/comb.h"

namespace coif::styles {

/// Moves targets (one a vertex, scene units) away from the head until the middles of faces, of their sides
/// and of the prisms between them keep `margin` head heights. Layer 0 stays; next to it the margin is a
/// quarter.
void pushOut(const HairMesh& mesh, std::vector<Vec3>& targets, const Surface& head, const HeadSpace& space,
             double margin, const Context& context);

}  // namespace coif::styles
