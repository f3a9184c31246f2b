// The binding of a head to its skeleton, out of a USD file.
#pragma once

#include <filesystem>
#include <optional>

#include "coif/base/result.h"
#include "coif/strands/skin.h"

namespace coif {

/// UsdSkel's binding primvars (`skel:jointIndices`, `skel:jointWeights`, `skel:geomBindTransform`,
/// `skel:joints`, `skel:skeleton`; the last two also from prims above) of the meshes that loadPolygonMesh
/// reads from `path`, an element a vertex of its mesh. Weights are scaled to add up to 1; vertices of meshes
/// that nothing binds have weights of 0. None when the file is no USD or binds nothing. Errors: those of
/// loadPolygonMesh; Malformed (sizes or joints that do not fit), Unsupported (meshes bound to different
/// skeletons or at different places).
Result<std::optional<SkinBinding>> loadSkinBinding(const std::filesystem::path& path);

}  // namespace coif
