// Hair meshes by columns, straight from the definition: root faces, a height a face, splits of root edges.
// Independent of the hairmesh room's operations.
#pragma once

#include <functional>

#include "coif/base/random.h"
#include "coif/hairmesh/hair_mesh.h"

namespace coif::placetest {

struct Columns {
  std::vector<Vec3> roots;
  std::vector<std::vector<std::uint32_t>> faces;
  std::vector<std::uint32_t> heights;  ///< by face
  std::vector<EdgeSplit> splits;       ///< sorted, a < b
};

/// (root position, layer, copy number of the vertex) → position.
using PositionOf = std::function<Vec3(const Vec3& root, std::uint32_t layer, std::uint32_t vertex)>;

HairMesh build(const Columns& columns, const PositionOf& position);

Columns grid(std::uint32_t nx, std::uint32_t ny, std::uint32_t height);
/// A closed cube surface of 6 n² quads.
Columns cube(std::uint32_t n, std::uint32_t height);
/// Heights drawn from {⌈n/2⌉, …, n} in square patches of `patch` faces of an nx-wide grid.
void mixHeights(Columns& columns, std::uint32_t nx, std::uint32_t patch, std::uint64_t seed);
/// Splits every vertical grid line x = s, 2s, … from `layer` upwards.
void splitLines(Columns& columns, std::uint32_t nx, std::uint32_t stride, std::uint32_t layer);

/// Straight hair of unit length with every coordinate of layers above 0 shaken by ±amount.
PositionOf shaken(double amount, std::uint64_t seed);

}  // namespace coif::placetest
