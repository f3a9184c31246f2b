// Hair meshes to grow on.
#pragma once

#include <cmath>
#include <vector>

#include "coif/base/random.h"
#include "coif/hairmesh/hair_mesh.h"
#include "coif/hairmesh/operations.h"

namespace coif::samples {

/// A grid of nx × ny unit-size squares in the xz plane.
inline HairMesh gridRoot(std::uint32_t nx, std::uint32_t ny, double side = 1) {
  std::vector<Vec3> positions;
  std::vector<std::uint32_t> offsets{0}, corners;
  for (std::uint32_t y = 0; y <= ny; ++y) {
    for (std::uint32_t x = 0; x <= nx; ++x) positions.emplace_back(side * x, 0, -side * y);
  }
  for (std::uint32_t y = 0; y < ny; ++y) {
    for (std::uint32_t x = 0; x < nx; ++x) {
      const std::uint32_t a = y * (nx + 1) + x, b = a + nx + 1;
      corners.insert(corners.end(), {a, a + 1, b + 1, b});
      offsets.push_back(std::uint32_t(corners.size()));
    }
  }
  return HairMesh::fromRoot(positions, offsets, corners).value();
}

/// All bundles extruded `layers` times, then every vertex above the root moved by up to `jitter`.
inline void raise(HairMesh& mesh, std::uint32_t layers, double step = 1, double jitter = 0) {
  for (std::uint32_t k = 0; k < layers; ++k) {
    std::vector<BundleId> bundles;
    for (const Bundle& bundle : mesh.bundles()) bundles.push_back(bundle.id);
    ExtrudeOptions options;
    options.direction = Vec3(0.2 * step * k, step, 0.1 * step * std::sin(double(k)));
    extrudeFaces(mesh, bundles, options).value();
  }
  const CounterRandom random(99);
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
    if (mesh.vertices()[v].layer == 0) continue;
    const Vec3 by(random.uniform(3 * v) - 0.5, random.uniform(3 * v + 1) - 0.5,
                  random.uniform(3 * v + 2) - 0.5);
    mesh.setPosition(v, mesh.position(v) + 2 * jitter * by);
  }
}

inline HairMesh grid(std::uint32_t nx, std::uint32_t ny, std::uint32_t layers, double jitter = 0,
                     double side = 1) {
  HairMesh mesh = gridRoot(nx, ny, side);
  raise(mesh, layers, side, jitter * side);
  return mesh;
}

/// One bundle over any root polygon.
inline HairMesh column(const std::vector<Vec3>& polygon, std::uint32_t layers, double step = 1) {
  std::vector<std::uint32_t> corners;
  for (std::uint32_t i = 0; i < polygon.size(); ++i) corners.push_back(i);
  HairMesh mesh =
      HairMesh::fromRoot(polygon, std::vector<std::uint32_t>{0, std::uint32_t(polygon.size())}, corners)
          .value();
  raise(mesh, layers, step);
  return mesh;
}

}  // namespace coif::samples
