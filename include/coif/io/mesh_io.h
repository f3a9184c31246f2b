// Polygon meshes in: OBJ, PLY, OFF, STL, GLB/glTF, USD text layers.
#pragma once

#include <filesystem>

#include "coif/base/result.h"
#include "coif/scalp/polygon_mesh.h"

namespace coif {

/// Reads every polygon of the file, in the scene's own coordinates (node and prim transforms applied),
/// choosing the reader by content first and extension second. Quads and n-gons survive; nothing is welded or
/// repaired; what is left out (points, lines, normals) is said in `notes`. At most 2 GiB of memory whatever
/// the file claims. Errors name the file and the line or byte: NotFound, Unreadable, Malformed, Unsupported,
/// TooLarge, Degenerate (values that are not finite).
Result<PolygonMesh> loadPolygonMesh(const std::filesystem::path& path);

/// Writes OBJ (quads and n-gons, groups, UVs) atomically.
Status savePolygonMesh(const PolygonMesh& mesh, const std::filesystem::path& path);

}  // namespace coif
