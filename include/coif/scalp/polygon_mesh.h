// A polygon mesh as it came from a file: quads and n-gons kept, nothing repaired.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "coif/base/result.h"
#include "coif/base/vec.h"

namespace coif {

enum class UpAxis { Y, Z };

/// V vertices, F faces of any size >= 3, counter-clockwise seen from outside, right-handed, lengths in the
/// file's own unit. Face f has corners [faceOffsets[f], faceOffsets[f+1]).
struct PolygonMesh {
  std::vector<Vec3> positions;                ///< V
  std::vector<std::uint32_t> faceOffsets{0};  ///< F + 1
  std::vector<std::uint32_t> corners;         ///< C vertex indices
  std::vector<Vec2> cornerUvs;                ///< C, or empty
  std::vector<std::uint32_t> faceGroups;      ///< F indices into groupNames, or empty
  std::vector<std::string> groupNames;        ///< groups and materials by name, as the file has them
  double metersPerUnit = 0;                   ///< 0: the file does not say
  UpAxis upAxis = UpAxis::Y;
  std::vector<std::string> notes;  ///< what the reader left out or had to assume, a sentence each

  std::size_t vertexCount() const { return positions.size(); }
  std::size_t faceCount() const { return faceOffsets.size() - 1; }
  std::span<const std::uint32_t> face(std::size_t f) const {
    return std::span(corners).subspan(faceOffsets[f], faceOffsets[f + 1] - faceOffsets[f]);
  }
  void addFace(std::span<const std::uint32_t> vertices);
};

/// Refuses what no later stage can use: a corner index out of range, a face of fewer than three corners, a
/// position that is not finite, arrays of mismatched length. Names the element.
Status validate(const PolygonMesh& mesh);

/// Axis-aligned box of the positions; empty mesh: zero box.
struct Box {
  Vec3 lo = Vec3::Zero(), hi = Vec3::Zero();
  double diagonal() const { return (hi - lo).norm(); }
};
Box bounds(std::span<const Vec3> points);

/// Newell normal of a polygon; its length is twice the (projected) area.
Vec3 newellNormal(std::span<const Vec3> polygon);

/// V unit normals for smooth shading: the faces' means by area; zero for a vertex without area around it.
/// `mesh` passes validate().
std::vector<Vec3> vertexNormals(const PolygonMesh& mesh);

}  // namespace coif
