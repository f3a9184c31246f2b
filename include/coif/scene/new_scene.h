// From a head and a hairstyle to a document.
#pragma once

#include <filesystem>
#include <optional>

#include "coif/scene/hairstyle.h"
#include "coif/scene/scene.h"

namespace coif {

/// The document of a hairstyle on a cage of the head read from `headFile`; the camera starts where the style
/// shows best, seen from the face's own front. The unit is the caller's, else the file's, else such that the
/// head is 24 cm tall. Errors: those of fileHash.
Result<Scene> sceneOnHead(const std::filesystem::path& headFile, const PolygonMesh& head, const Cage& cage,
                          Hairstyle hairstyle, std::optional<double> metersPerUnit = {});

/// The cage's faces as a root layer without hair: what an artist starts from. Errors: those of
/// HairMesh::fromRoot.
Result<Hairstyle> bareRoots(const Cage& cage);

}  // namespace coif
