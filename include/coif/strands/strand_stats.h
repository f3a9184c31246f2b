// Numbers about a strand set, for `coif info` and for checks.
#pragma once

#include <cstdint>

#include "coif/base/context.h"
#include "coif/scalp/surface.h"
#include "coif/strands/strand_set.h"

namespace coif {

struct StrandStats {
  std::uint64_t strands = 0, points = 0;
  std::uint64_t notFinite = 0;   ///< points with a coordinate that is not finite; left out of all below
  std::uint64_t zeroLength = 0;  ///< strands of at least one point and no length
  std::uint64_t fewestPoints = 0, mostPoints = 0;
  double shortest = 0, longest = 0, meanLength = 0;  ///< scene units
  double least = 0, greatest = 0;                    ///< diameters; 0 without widths
  Box box;
};

/// The set must pass validate(strands, false). Same bits for any number of threads.
StrandStats strandStats(const StrandSet& strands, const Context& context = {});

/// Share of the points of strands that lie inside a closed surface: winding number above one half. The first
/// `skip` points of every strand are left out (roots lie on the head); `samples` points at most, evenly
/// chosen; 0 without any.
double insideFraction(const StrandSet& strands, const Surface& surface, std::size_t skip = 1,
                      std::size_t samples = 100000, const Context& context = {});

}  // namespace coif
