// checkInvariants() for a caller that has the topology already.
#pragma once

#include "coif/hairmesh/invariants.h"
#include "hairmesh/topology.h"

namespace coif::hairmesh {

/// topology: of this very mesh, or null to have it built here.
std::vector<InvariantFault> checkWithTopology(const HairMesh& mesh, const Topology* topology);

}  // namespace coif::hairmesh
