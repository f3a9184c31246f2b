// What growing a whole head of hair costs, beside the memory it fills.
#pragma once

#include "bench/bench.h"

namespace coif {

/// Time of grow() for 100 000 × 32 points on all cores against allocating and filling buffers of the same
/// size, and peak memory of a million strands against their own bytes.
std::vector<BenchFigure> growthFigures(const BenchOptions& options);

}  // namespace coif
