// What is true of every hair mesh, each as a named check.
//
// Names: "id" (ascending, below the counters), "finite", "corner-count" (>= 3, whole rows), "index",
// "face-once" (a face names a vertex once, a bundle a face once), "layer" (a vertex serves its own layer
// only), "parent" (one layer down, the same corner of the same bundle: so one-to-many holds), "unused" (a
// vertex of no face), "group", "root" (the root layer is manifold with boundary, without bow-ties; a split
// names a shared root edge), "split" (sorted, once an edge, 1 <= layer <= the lower of the two heights),
// "joined" (an edge shared on a layer has the same two vertices on both sides), "bow-tie" (a vertex of
// several fans is marked welded, and only such).
#pragma once

#include <string>
#include <vector>

#include "coif/hairmesh/hair_mesh.h"

namespace coif {

struct InvariantFault {
  std::string name;     ///< of the check
  std::string element;  ///< "vertex 12", "bundle 3", by id
  std::string message;  ///< one sentence
};

/// Every fault, in a fixed order; empty for a sound mesh. After a fault that makes indices meaningless the
/// later checks are left out. Cost: linear; about 0.1 ms for 200 bundles of five layers.
std::vector<InvariantFault> checkInvariants(const HairMesh& mesh);

}  // namespace coif
