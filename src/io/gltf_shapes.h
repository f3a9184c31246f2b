// Triangles for viewers: strands as ribbons or tubes, polygon meshes, the outside of a hair mesh.
#pragma once

#include "io/formats.h"

namespace coif::io {

/// One glTF primitive. Arrays of V entries, `uvs` maybe empty; normals are unit.
struct TriangleMesh {
  std::vector<Vec3f> positions, normals;
  std::vector<Vec2f> uvs;
  std::vector<std::uint32_t> indices;
};

/// The first `limit` strands at most, as flat ribbons that face away from the roots' centre (Cards) or as
/// prisms of three sides (Tubes), widened so that they cover as much as all strands do. u runs across, v from
/// root to tip. Strands without length are left out. Cost: linear in all points.
TriangleMesh strandShapes(const StrandSet& strands, StrandMesh shape, std::size_t limit);

/// Triangulated, a vertex for each pair of position and UV, normals the area-weighted mean of the faces
/// around. Error: Degenerate, for a position beyond the range of float.
Result<TriangleMesh> trianglesOf(const PolygonMesh& mesh);

/// What a hair mesh shows from outside: root faces, tip faces and exposed sides.
PolygonMesh outsideOf(const HairMesh& mesh);

}  // namespace coif::io
