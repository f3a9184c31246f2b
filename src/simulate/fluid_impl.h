// The air's grid: velocities on the faces between cells, pressure in their middles.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "coif/base/parallel.h"
#include "coif/simulate/air.h"

namespace coif {

struct FluidWind::Impl {
  FluidOptions options;
  AirObstacle obstacle;
  std::array<long, 3> n{};  ///< cells
  double cell = 1;
  std::array<std::vector<double>, 3> face, next;  ///< velocity components on the faces across each axis
  std::vector<double> pressure, residual, direction, product, diagonal, divergence;
  std::vector<std::uint8_t> solid;  ///< by cell
  PointSplatter splatter;
  std::vector<Vec3> points;
  std::vector<double> values;
  std::vector<float> hair;  ///< mass and momentum densities
  GridFrame hairFrame;
  bool hasHair = false;
  FluidReport report;

  std::size_t cellCount() const { return std::size_t(n[0] * n[1] * n[2]); }
  std::size_t cellIndex(long i, long j, long k) const { return std::size_t((k * n[1] + j) * n[0] + i); }
  std::array<long, 3> faceDims(int axis) const {
    std::array<long, 3> dims = n;
    ++dims[std::size_t(axis)];
    return dims;
  }
  std::size_t faceIndex(int axis, long i, long j, long k) const {
    const auto dims = faceDims(axis);
    return std::size_t((k * dims[1] + j) * dims[0] + i);
  }
  Vec3 facePoint(int axis, const std::array<long, 3>& at) const {
    Vec3 offset = Vec3::Constant(0.5);
    offset[axis] = 0;
    return options.lo + cell * (Vec3(double(at[0]), double(at[1]), double(at[2])) + offset);
  }

  double sample(int axis, const Vec3& position) const;
  Vec3 velocity(const Vec3& position) const;
  template <class Body>
  void forFaces(int axis, const Context& context, Body&& body) const;
  void reset();
  void findSolids(const Context& context);
  void advect(double timeStep, const Context& context);
  void splatHair(const NodeView& nodes, const Context& context);
  void dragHair(double timeStep, const Context& context);
  void holdSolids(const Context& context);
  void project(const Context& context);
  double measure(const Context& context);
  void applyMatrix(const std::vector<double>& in, std::vector<double>& out, const Context& context) const;
  double dot(const std::vector<double>& a, const std::vector<double>& b, const Context& context) const;
  template <class Visit>
  void forNeighbours(long i, long j, long k, Visit&& visit) const;
};

/// body(index, at) for every face across `axis`.
template <class Body>
void FluidWind::Impl::forFaces(int axis, const Context& context, Body&& body) const {
  const auto dims = faceDims(axis);
  parallelFor(context, std::size_t(dims[1] * dims[2]), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      const long j = long(row) % dims[1], k = long(row) / dims[1];
      for (long i = 0; i < dims[0]; ++i) body(faceIndex(axis, i, j, k), std::array<long, 3>{i, j, k});
    }
  });
}

}  // namespace coif
