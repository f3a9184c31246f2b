// How much hair is where: the grid that light (Bertails et al. 2005) and dynamics share.
#pragma once

#include <span>
#include <vector>

#include "coif/base/context.h"
#include "coif/base/vec.h"

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

}  // namespace coif
