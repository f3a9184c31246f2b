#include "coif/scene/scene.h"

#include <bit>

#include "coif/base/random.h"

namespace coif {

std::filesystem::path Scene::headPath() const {
  if (head.path.is_absolute() || file.empty()) return head.path;
  return file.parent_path() / head.path;
}

std::uint64_t meshHash(const HairMesh& mesh) {
  std::uint64_t hash = 0;
  const auto add = [&](std::uint64_t value) { hash = hashCombine(hash, value); };
  for (const HairVertex& vertex : mesh.vertices()) {
    add(std::uint64_t(vertex.id) << 2 | std::uint64_t(vertex.pinned) << 1 | std::uint64_t(vertex.welded));
    for (int axis = 0; axis < 3; ++axis) add(std::bit_cast<std::uint64_t>(vertex.position[axis]));
  }
  for (const Bundle& bundle : mesh.bundles()) {
    add(std::uint64_t(bundle.id) << 32 | bundle.corners);
    add(bundle.group);
    for (std::uint32_t vertex : bundle.vertices) add(vertex);
  }
  for (const EdgeSplit& split : mesh.splits()) add(split.a), add(split.b), add(split.layer);
  return hash;
}

}  // namespace coif
