#include "coif/scene/scene.h"

#include <algorithm>
#include <bit>

#include "coif/base/random.h"
#include "coif/io/safe_file.h"
#include "scene/scene_folder.h"

namespace coif {

std::filesystem::path Scene::headPath() const {
  if (head.path.is_absolute() || file.empty()) return head.path;
  return scene::folderOf(file) / head.path;
}

std::filesystem::path scene::folderOf(const std::filesystem::path& sceneFile) {
  std::error_code failed;
  if (!std::filesystem::is_symlink(sceneFile, failed)) return sceneFile.parent_path();
  return std::filesystem::weakly_canonical(sceneFile, failed).parent_path();
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

Result<std::uint64_t> fileHash(const std::filesystem::path& path) {
  COIF_ASSIGN(const auto bytes, readFile(path));
  std::uint64_t hash = bytes.size();
  for (std::size_t i = 0; i < bytes.size(); i += 8) {
    std::uint64_t word = 0;
    for (std::size_t j = i; j < std::min(bytes.size(), i + 8); ++j)
      word = word << 8 | std::uint64_t(bytes[j]);
    hash = hashCombine(hash, word);
  }
  return hash;
}

}  // namespace coif
