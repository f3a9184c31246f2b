// GridDeposit's inner loop: segments clipped to cells, 16 at a time.
#pragma once

#include <cmath>
#include <span>

#include "coif/strands/density_grid.h"

namespace coif {

/// Points that may be read, not used, behind a task's.
inline constexpr std::size_t kReadBehind = 4;

/// Says by a weight's sign that no segment begins at a point; the segment before it needs the weight.
inline float lastOfRun(float weight) {
  return -std::abs(weight);
}

struct DepositTask {
  /// Segments lead from each to the next but where lastOfRun() says no, as it has to of the last one.
  std::span<const GridPoint> points;
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
