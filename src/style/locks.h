// Which centre each strand gathers around.
#pragma once

#include "style/embedding.h"

namespace coif::style {

/// Centres are the first `count` strands among those of `group` (kNone: of all). Roots come in a progressive
/// order, so these are blue noise, and the same whatever the number of strands. A strand takes the centre
/// with the nearest root among those that its bundle reaches without crossing a parting (a separated edge).
/// Returns the centres' strand indices, ascending; `centreOf` counts through them, kNone for strands outside
/// the group or out of reach. Same for any number of threads.
struct LockChoice {
  std::vector<std::uint32_t> centres, centreOf;
};
LockChoice chooseLocks(const HairMesh& mesh, const Embedding& embedding, std::uint32_t count,
                       std::uint32_t group, const Context& context);

}  // namespace coif::style
