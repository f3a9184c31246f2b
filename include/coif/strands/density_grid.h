// How much hair is where: the grid that light (Bertails et al. 2005) and dynamics share.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
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
/// length to float's rounding. Addresses wrap: cell (i, j, k) is that of its indices modulo n.
class GridDeposit {
 public:
  static constexpr int kSlabRows = 8;
  enum class Length { Whole, AcrossLast };

  /// Writes the points of strands [begin, end), whose weights are numbers; called from several threads.
  using Source = std::function<void(std::size_t begin, std::size_t end, std::span<GridPoint> out)>;

  GridDeposit(int log2Size, Length length);
  /// Takes segments; `offsets` as in StrandSet. Every strand's points are asked for once and kept by slabs.
  /// May be called again, in the same memory.
  void bin(std::span<const std::uint64_t> offsets, const Source& source, const Context& context);

  /// Low corner of the cells that hair is in, less one guard cell; zero without hair.
  const std::array<long, 3>& first() const { return first_; }
  /// Whether one turn of the addresses holds all cells that hair is in, without two sharing one.
  bool fits() const { return fits_; }
  int slabCount() const { return (1 << log2Size_) / kSlabRows; }
  /// Floats that a slab takes: kSlabRows · n².
  std::size_t slabCells() const { return std::size_t(kSlabRows) << (2 * log2Size_); }
  /// Index of a cell in its slab, which is (j mod n) / kSlabRows.
  std::size_t cellInSlab(long i, long j, long k) const {
    const long mask = (1L << log2Size_) - 1;
    return (std::size_t((k & mask) * kSlabRows + (j & (kSlabRows - 1))) << log2Size_) | std::size_t(i & mask);
  }
  /// Whether there may be hair in a slab.
  bool reaches(int slab) const;
  /// Adds a slab's hair to its cells. `lanes` (4, 8, 16; 0: as many as the processor has) changes no byte.
  /// Requires fits().
  void add(int slab, std::span<float> cells, int lanes = 0) const;

 private:
  int log2Size_ = 7;
  Length length_ = Length::Whole;
  std::array<long, 3> first_{0, 0, 0};
  bool fits_ = true;
  /// Points of some strands, slab by slab and in order within one; a few more than are there may be read.
  struct Chunk {
    std::vector<GridPoint> points;
    std::vector<std::uint32_t> begins;  ///< of the slabs' points, and an end
    std::span<const GridPoint> in(int slab) const;
  };
  std::vector<Chunk> chunks_;
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

}  // namespace coif
