#include "coif/strands/point_splat.h"

#include "coif/base/check.h"
#include "coif/base/parallel.h"

namespace coif {

GridFrame frameAround(const Vec3& lo, const Vec3& hi, double cell, int maxLog2Size) {
  GridFrame frame;
  const Vec3 extents = hi - lo;
  if (!lo.allFinite() || !extents.allFinite() || !(cell > 0)) return frame;
  frame.cell = cell;
  frame.log2Size = 3;
  const double widest = extents.maxCoeff();
  while (widest > frame.cell * (frame.size() - 4)) {
    if (frame.log2Size < maxLog2Size) {
      ++frame.log2Size;
    } else {
      frame.cell *= 2;
    }
  }
  // On multiples of the cell, so that a box that creeps does not make densities flicker.
  for (int axis = 0; axis < 3; ++axis)
    frame.origin[axis] = (std::floor(lo[axis] / frame.cell) - 2) * frame.cell;
  return frame;
}

/// Points sorted by the slab (k of the middle cell) they lie in, in point order within a slab.
void PointSplatter::bucket(const GridFrame& frame, std::span<const Vec3> points) {
  const std::size_t n = std::size_t(frame.size());
  slabOffsets_.assign(n + 1, 0);
  order_.resize(points.size());
  const auto slabOf = [&](const Vec3& point) {
    return std::size_t(long(std::floor(frame.cellsFromWorld(point)[2])) & long(n - 1));
  };
  for (const Vec3& point : points) {
    if (point.allFinite()) ++slabOffsets_[slabOf(point) + 1];
  }
  for (std::size_t s = 0; s < n; ++s) slabOffsets_[s + 1] += slabOffsets_[s];
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (points[p].allFinite()) order_[slabOffsets_[slabOf(points[p])]++] = std::uint32_t(p);
  }
  for (std::size_t s = n; s > 0; --s) slabOffsets_[s] = slabOffsets_[s - 1];
  slabOffsets_[0] = 0;
}

/// Every slab of cells takes what the points of its own and its two neighbours' slabs give it.
template <class Add>
void PointSplatter::gather(const GridFrame& frame, std::span<const Vec3> points, const Context& context,
                           Add&& add) {
  bucket(frame, points);
  const long n = frame.size();
  parallelFor(context, std::size_t(n), 1, [&](std::size_t begin, std::size_t end) {
    for (long slab = long(begin); slab < long(end); ++slab) {
      for (long offset = -1; offset <= 1; ++offset) {
        const auto source = std::size_t((slab + offset) & (n - 1));
        for (std::uint32_t at = slabOffsets_[source]; at < slabOffsets_[source + 1]; ++at) {
          const std::uint32_t p = order_[at];
          const SplatStencil stencil(frame.cellsFromWorld(points[p]));
          add(p, stencil, std::size_t(1 - offset), slab);
        }
      }
    }
  });
}

/// kChannels values a point.
template <std::size_t kChannels>
void PointSplatter::splatChannels(const GridFrame& frame, std::span<const Vec3> points,
                                  std::span<const double> values, std::vector<float>& grid,
                                  const Context& context) {
  const auto n = std::size_t(frame.size());
  grid.assign(n * n * n * kChannels, 0.0f);
  gather(frame, points, context, [&](std::uint32_t p, const SplatStencil& stencil, std::size_t k, long slab) {
    float value[kChannels];
    for (std::size_t c = 0; c < kChannels; ++c)
      value[c] = float(stencil.weight[2][k] * values[p * kChannels + c]);
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t i = 0; i < 3; ++i) {
        const auto w = float(stencil.weight[0][i] * stencil.weight[1][j]);
        float* cell =
            &grid[kChannels * frame.index(stencil.first[0] + long(i), stencil.first[1] + long(j), slab)];
        for (std::size_t c = 0; c < kChannels; ++c) cell[c] += w * value[c];
      }
    }
  });
}

void PointSplatter::splat(const GridFrame& frame, std::span<const Vec3> points,
                          std::span<const double> values, std::size_t channels, std::vector<float>& grid,
                          const Context& context) {
  COIF_CHECK(channels == 1 || channels == 4, "points are spread one or four values at a time");
  if (channels == 1) {
    splatChannels<1>(frame, points, values, grid, context);
  } else {
    splatChannels<4>(frame, points, values, grid, context);
  }
}

void PointSplatter::splatSlopes(const GridFrame& frame, std::span<const Vec3> points,
                                std::span<const double> values, std::vector<float>& grid,
                                const Context& context) {
  const auto n = std::size_t(frame.size());
  grid.assign(n * n * n, 0.0f);
  gather(frame, points, context, [&](std::uint32_t p, const SplatStencil& stencil, std::size_t k, long slab) {
    const double value = values[p] / frame.cell, z = stencil.weight[2][k], sz = std::abs(stencil.slope[2][k]);
    for (std::size_t j = 0; j < 3; ++j) {
      const double y = stencil.weight[1][j], sy = std::abs(stencil.slope[1][j]);
      for (std::size_t i = 0; i < 3; ++i) {
        const double x = stencil.weight[0][i], sx = std::abs(stencil.slope[0][i]);
        grid[frame.index(stencil.first[0] + long(i), stencil.first[1] + long(j), slab)] +=
            float(value * (sx * y * z + x * sy * z + x * y * sz));
      }
    }
  });
}

}  // namespace coif
