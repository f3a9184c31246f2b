// Where a scene's relative paths start from.
#pragma once

#include <filesystem>

namespace coif::scene {

/// The folder of the file itself, not of a link to it.
std::filesystem::path folderOf(const std::filesystem::path& sceneFile);

}  // namespace coif::scene
