// How much hair is where: the grid that light (Bertails et al. 2005) and dynamics share.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "coif/base/context.h"
#include "coif/base/result.h"
#include "coif/base/vec.h"
#include "coif/strands/strand_set.h"

namespace coif {

/// A box of n = 2^log2Size cells a side in a rotated frame. Indices wrap (floor, then modulo), so that a box
/// of fixed size follows the hair; two points more than extent() apart along an axis would share a cell,
/// which holds() tells.
struct GridFrame {
  Mat3 gridFromWorld = Mat3::Identity();  ///< a rotation; its last row is what "along the light" means
  Vec3 origin = Vec3::Zero();             ///< in the grid's frame: the low corner of the hair's box
  double cell = 1;                        ///< size of a cell, scene units
  int log2Size = 7;

  int size() const { return 1 << log2Size; }
  double extent() const { return cell * size(); }
  /// In cells, from the origin; cell (i, j, k) covers [i, i + 1) × ….
  Vec3 cellsFromWorld(const Vec3& world) const { return (gridFromWorld * world - origin) / cell; }
  std::size_t index(long i, long j, long k) const {
    const long mask = size() - 1;
    return (std::size_t(k & mask) << (2 * log2Size)) | (std::size_t(j & mask) << log2Size) |
           std::size_t(i & mask);
  }
  /// Whether a box of these extents, in the grid's frame, fits with one guard cell on every side.
  bool holds(const Vec3& extents) const { return (extents.array() <= cell * (size() - 2)).all(); }
};

struct DensityGrid {
  GridFrame frame;
  std::vector<float> values;  ///< n³, i fastest; meaning by whoever filled it
};

/// A point in cells (not wrapped) and what a unit of a hair's length weighs there. A segment with an end of
/// negative weight is left out.
struct GridPoint {
  float x = 0, y = 0, z = 0, weight = 0;
};

/// Clips segments exactly at the cells' faces and adds weight × length to every cell they pass; by slabs of
/// rows that threads can fill apart from each other. Weight is linear along a segment; length is measured
/// along all axes, or across the last one ("along the light") only. The sum over all cells is Σ weight ×
/// length to float's rounding.
class GridDeposit {
 public:
  static constexpr int kSlabRows = 8;
  enum class Length { Whole, AcrossLast };

  /// `points` and `offsets` as in StrandSet; read once.
  GridDeposit(std::span<const GridPoint> points, std::span<const std::uint64_t> offsets, int log2Size,
              Length length, const Context& context = {});

  /// Low corner of the cells that hair is in, less one guard cell; zero without hair.
  const std::array<long, 3>& first() const { return first_; }
  /// Whether one turn of the addresses holds all cells that hair is in, without two sharing one.
  bool fits() const { return fits_; }
  int slabCount() const { return (1 << log2Size_) / kSlabRows; }
  /// Floats that a slab takes, and flags: kSlabRows · n² and kSlabRows · n.
  std::size_t slabCells() const { return std::size_t(kSlabRows) << (2 * log2Size_); }
  std::size_t slabRows() const { return std::size_t(kSlabRows) << log2Size_; }
  /// Rows j = slab · kSlabRows + 0 … kSlabRows − 1, counted from first() and not wrapped, into a slab of its
  /// own: row (k, j) begins at (k · kSlabRows + j mod kSlabRows) · n. `touched`, zero when called, is set for
  /// rows that hair is in; `cells` of others are left as they were. Apart from the grid, because a column of
  /// it falls onto few lines of the cache. Requires fits().
  void fill(int slab, std::span<float> cells, std::span<std::uint8_t> touched) const;

 private:
  /// Ends relative to first(), in the order of the points; copied, so that a slab reads them in one go.
  struct Segment {
    GridPoint a, b;
  };
  int log2Size_ = 7;
  Length length_ = Length::Whole;
  std::array<long, 3> first_{0, 0, 0};
  bool fits_ = true;
  std::vector<std::vector<std::vector<Segment>>> bins_;  ///< chunk, slab
};

struct DensityReport {
  std::size_t droppedStrands = 0;  ///< with a point or width that is not finite
};

/// Volume of hair over volume of cell, π/4 Σ ℓ D² / cell³, on the frame's grid. `defaultWidth` where the
/// strands have no widths. Errors: InvalidArgument (a frame whose cell is not positive, log2Size outside 3 …
/// 10, defaultWidth negative), TooLarge (the hair does not fit the box: see GridFrame::holds), Cancelled.
/// Cost: a few ten nanoseconds a segment and a thread. Same bytes for any number of threads.
Result<DensityGrid> depositHairVolume(const StrandSet& strands, const GridFrame& frame, double defaultWidth,
                                      const Context& context = {}, DensityReport* report = nullptr);

/// Floor without a library call; |v| < 2⁶².
template <class Real>
long floorToLong(Real v) {
  const long truncated = long(v);
  return truncated - (v < Real(truncated));
}

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
