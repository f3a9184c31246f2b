// GridDeposit's inner loop: segments clipped to cells, 16 at a time.
#pragma once

#include <cstdint>
#include <span>

#include "coif/strands/density_grid.h"

namespace coif {

struct DepositTask {
  std::span<const GridPoint> points;
  std::span<const SegmentRun> runs;
  float origin[3] = {0, 0, 0};  ///< a multiple of the grid's size below all cells that hair is in
  int log2Size = 7;
  int rowBegin = 0;         ///< of the slab, wrapped
  bool acrossLast = false;  ///< GridDeposit::Length
  float* cells = nullptr;   ///< the slab's
};

/// Adds weight × length to the slab's cells, in the same order and with the same bytes for any number of
/// lanes (4, 8 or 16; the processor has to have them).
void depositSegments(const DepositTask& task, int lanes);

}  // namespace coif
