#include "scene/sample_scene.h"

#include <stdexcept>

#include "coif/hairmesh/operations.h"

namespace coif::test {

Scene sampleScene() {
  // A 2 × 2 grid of unit quads in the plane z = 0.
  std::vector<Vec3> positions;
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 3; ++x) positions.emplace_back(x, y, 0);
  }
  std::vector<std::uint32_t> offsets = {0}, corners;
  for (std::uint32_t y = 0; y < 2; ++y) {
    for (std::uint32_t x = 0; x < 2; ++x) {
      const std::uint32_t v = 3 * y + x;
      corners.insert(corners.end(), {v, v + 1, v + 4, v + 3});
      offsets.push_back(std::uint32_t(corners.size()));
    }
  }
  Scene scene;
  scene.name = "sample";
  scene.head.path = "head.obj";
  scene.hairMesh = HairMesh::fromRoot(positions, offsets, corners).value();
  std::vector<BundleId> all;
  for (const Bundle& bundle : scene.hairMesh.bundles()) all.push_back(bundle.id);
  ExtrudeOptions up;
  up.direction = Vec3(0.1, 0, 1);
  for (int layer = 0; layer < 3; ++layer) {
    if (!extrudeFaces(scene.hairMesh, all, up).ok())
      throw std::runtime_error("the sample could not be extruded");
  }
  if (!separateEdge(scene.hairMesh, {all[0], 2, 1}).ok())
    throw std::runtime_error("the sample could not be parted");
  scene.hairMesh.setGroup(1, scene.hairMesh.addGroup("fringe"));
  scene.hairMesh.setPinned(scene.hairMesh.bundles()[0].face(1)[2], true);
  return scene;
}

}  // namespace coif::test
