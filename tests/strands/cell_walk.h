// Segments clipped to cells one after the other, in any precision: what GridDeposit's lanes are held against.
#pragma once

#include <algorithm>
#include <cmath>

#include "coif/strands/density_grid.h"

namespace coif {

/// visit(i, j, k, from, to) for every cell that the segment a → b passes, in order; [from, to] is the part of
/// it, in [0, 1]. Coordinates in cells, within ± 2³⁰.
template <class Real, class Visit>
void forEachCell(const Eigen::Matrix<Real, 3, 1>& a, const Eigen::Matrix<Real, 3, 1>& b, Visit&& visit) {
  long cell[3], step[3];
  int left[3];
  Real next[3], stride[3];
  int count = 1;
  for (int d = 0; d < 3; ++d) {
    cell[d] = floorToLong(a[d]);
    const long steps = floorToLong(b[d]) - cell[d];
    step[d] = steps < 0 ? -1 : 1;
    left[d] = int(steps < 0 ? -steps : steps);
    count += left[d];
    next[d] = 2, stride[d] = 0;
    if (left[d] == 0) continue;
    const Real perDelta = 1 / (b[d] - a[d]);
    stride[d] = std::abs(perDelta);
    next[d] = (Real(cell[d] + (steps > 0)) - a[d]) * perDelta;
  }
  // The number of faces is known beforehand, so rounding can displace a crossing but never lose one.
  Real from = 0;
  for (; count > 1; --count) {
    const int d = next[0] <= next[1] ? (next[0] <= next[2] ? 0 : 2) : (next[1] <= next[2] ? 1 : 2);
    const Real to = std::clamp(next[d], from, Real(1));
    visit(cell[0], cell[1], cell[2], from, to);
    from = to;
    cell[d] += step[d];
    next[d] = --left[d] > 0 ? next[d] + stride[d] : 2;
  }
  visit(cell[0], cell[1], cell[2], from, Real(1));
}

}  // namespace coif
