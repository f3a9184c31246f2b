// Polygons as triangles: a fan where the polygon is convex, ear clipping where it is not.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "coif/scalp/polygon_mesh.h"

namespace coif {

/// T triangles. Corner numbers index PolygonMesh::corners, so UVs and vertices both follow.
struct Triangulation {
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< T corner triples
  std::vector<std::uint32_t> faces;                     ///< T, the polygon of each triangle
};

/// Every face with corners in range and finite positions; the others are left out. A face of n corners gives
/// n − 2 triangles, zero-area ones included. Cost: linear; a concave face of n corners up to n³, so beyond
/// 1000 corners it is fanned.
Triangulation triangulate(const PolygonMesh& mesh);

}  // namespace coif
