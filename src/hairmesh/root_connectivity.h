// Who shares which edge of the root layer, by OpenMesh.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coif/base/result.h"

namespace coif::hairmesh {

/// For every side (face f, side i at offsets[f] + i) of a polygon soup the side that runs along the same edge
/// the other way, or kNone. corners: indices below vertexCount, distinct within a face. Errors (Degenerate,
/// naming face or vertex): an edge of three or more faces, two faces along an edge the same way, a vertex
/// whose faces form more than one fan. Cost: linear in the corners.
Result<std::vector<std::uint32_t>> oppositeSides(std::uint32_t vertexCount,
                                                 std::span<const std::uint32_t> offsets,
                                                 std::span<const std::uint32_t> corners);

}  // namespace coif::hairmesh
