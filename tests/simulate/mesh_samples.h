// Hair meshes to move, and the world they move in.
#pragma once

#include <gtest/gtest.h>

#include "coif/hairmesh/operations.h"
#include "coif/simulate/simulation.h"

namespace coif::samples {

/// 3 × 3 quads of side 1 at height 0, columns of `layers` layers of length 1 along `direction`.
inline HairMesh patch(const Vec3& direction, int layers = 4) {
  std::vector<Vec3> positions;
  std::vector<std::uint32_t> offsets{0}, corners;
  for (int z = 0; z < 4; ++z)
    for (int x = 0; x < 4; ++x) positions.emplace_back(x, 0, z);
  for (std::uint32_t z = 0; z < 3; ++z) {
    for (std::uint32_t x = 0; x < 3; ++x) {
      const std::uint32_t a = z * 4 + x;
      corners.insert(corners.end(), {a, a + 4, a + 5, a + 1});
      offsets.push_back(std::uint32_t(corners.size()));
    }
  }
  HairMesh mesh = HairMesh::fromRoot(positions, offsets, corners).value();
  std::vector<BundleId> all;
  for (const Bundle& bundle : mesh.bundles()) all.push_back(bundle.id);
  for (int layer = 0; layer < layers; ++layer) {
    ExtrudeOptions options;
    options.direction = direction;
    EXPECT_TRUE(extrudeFaces(mesh, all, options).ok());
  }
  return mesh;
}

inline SimulationWorld centimetres(double fps = 24) {
  SimulationWorld world;
  world.metersPerUnit = 0.01;
  world.framesPerSecond = fps;
  return world;
}

}  // namespace coif::samples
