// Which chains run side by side: those of one topology, one kind of joint and one colour.
#pragma once

#include <cstdint>
#include <vector>

#include "coif/simulate/chain.h"

namespace coif {

/// Trees of one shape. Neighbours by a lateral spring have different colours: a colour's trees are solved at
/// once, against what the others have come to.
struct ChainBin {
  std::vector<std::int32_t> parents;  ///< local indices, −1 for the root
  std::vector<std::int32_t> slots;    ///< stash of a node with several children, or −1
  std::int32_t slotCount = 0;
  bool bend = false, curved = false, anyFree = false;
  std::uint32_t colour = 0;
  std::vector<std::uint32_t> trees;
};

/// Ordered by colour, then by shape: the same for the same chains.
std::vector<ChainBin> binChains(const ChainSet& chains, bool skipBending);

/// Tree of each node.
std::vector<std::uint32_t> treeOfNodes(const ChainSet& chains);

}  // namespace coif
