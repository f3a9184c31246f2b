// Points spread over a grid with the quadratic B-spline, and its exact derivative: what repulsion and wind
// ask of hair (Bertails et al. 2005 for the density; the kernel is that of particle-in-cell methods).
#pragma once

#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "coif/base/context.h"
#include "coif/strands/density_grid.h"

namespace coif {

/// The 3 × 3 × 3 cells that a point touches: the first of them and, by axis, weights and their derivatives
/// per cell. Values lie at cell centres. Weights are >= 0, add to 1 and are once continuously differentiable.
struct SplatStencil {
  std::array<long, 3> first{};
  std::array<std::array<double, 3>, 3> weight{}, slope{};

  explicit SplatStencil(const Vec3& cells) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double base = std::floor(cells[long(axis)]);
      const double t = cells[long(axis)] - base;  // in [0, 1); 0.5 is the centre of the middle cell
      first[axis] = long(base) - 1;
      weight[axis] = {0.5 * (1 - t) * (1 - t), 0.75 - (t - 0.5) * (t - 0.5), 0.5 * t * t};
      slope[axis] = {t - 1, 1 - 2 * t, t};
    }
  }

  /// visit(i, j, k, weight, gradient per cell) for the 27 cells, i fastest.
  template <class Visit>
  void forEach(Visit&& visit) const {
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t j = 0; j < 3; ++j) {
        for (std::size_t i = 0; i < 3; ++i) {
          const double x = weight[0][i], y = weight[1][j], z = weight[2][k];
          visit(first[0] + long(i), first[1] + long(j), first[2] + long(k), x * y * z,
                Vec3(slope[0][i] * y * z, x * slope[1][j] * z, x * y * slope[2][k]));
        }
      }
    }
  }
};

/// An axis-aligned frame of the given cell that holds the box with two guard cells a side; the cell is
/// doubled while the grid would need more than 2^maxLog2Size cells a side. Errors: none; a box that is not
/// finite gives a unit frame.
GridFrame frameAround(const Vec3& lo, const Vec3& hi, double cell, int maxLog2Size = 7);

/// Adds value_c(p) · W(p, cell) over all points to channel c of every cell: `channels` (1 or 4) values a
/// point, row-major, and n³ × channels floats a grid, channel fastest. Points that are not finite are left
/// out. Deterministic for any number of threads: slabs of cells gather in point order. Cost: 81 multiply–adds
/// a point and channel; keeps its buckets between calls.
class PointSplatter {
 public:
  void splat(const GridFrame& frame, std::span<const Vec3> points, std::span<const double> values,
             std::size_t channels, std::vector<float>& grid, const Context& context = {});
  /// The same with value · (|∂W/∂x| + |∂W/∂y| + |∂W/∂z|), per world length: one channel.
  void splatSlopes(const GridFrame& frame, std::span<const Vec3> points, std::span<const double> values,
                   std::vector<float>& grid, const Context& context = {});

 private:
  void bucket(const GridFrame& frame, std::span<const Vec3> points);
  template <class Add>
  void gather(const GridFrame& frame, std::span<const Vec3> points, const Context& context, Add&& add);
  template <std::size_t kChannels>
  void splatChannels(const GridFrame& frame, std::span<const Vec3> points, std::span<const double> values,
                     std::vector<float>& grid, const Context& context);
  std::vector<std::uint32_t> slabOffsets_, order_;
};

}  // namespace coif
