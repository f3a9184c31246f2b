#include "coif/scalp/polygon_mesh.h"

#include <Eigen/Geometry>

namespace coif {

void PolygonMesh::addFace(std::span<const std::uint32_t> vertices) {
  corners.insert(corners.end(), vertices.begin(), vertices.end());
  faceOffsets.push_back(std::uint32_t(corners.size()));
}

namespace {

std::string facePlace(std::size_t f) {
  return "face " + std::to_string(f);
}

Status validateOffsets(const PolygonMesh& mesh) {
  const auto& offsets = mesh.faceOffsets;
  if (offsets.empty() || offsets.front() != 0)
    return makeError(ErrorCode::Malformed, "The face offsets must start with 0.");
  if (offsets.back() != mesh.corners.size())
    return makeError(ErrorCode::Malformed, "The face offsets end at " + std::to_string(offsets.back()) +
                                               " but there are " + std::to_string(mesh.corners.size()) +
                                               " corners.");
  for (std::size_t f = 0; f + 1 < offsets.size(); ++f) {
    if (offsets[f + 1] < offsets[f] || offsets[f + 1] > mesh.corners.size())
      return makeError(ErrorCode::Malformed, "The face offsets must not descend.", facePlace(f));
    if (offsets[f + 1] - offsets[f] < 3)
      return makeError(ErrorCode::Malformed, "A face needs three corners or more.", facePlace(f));
  }
  return {};
}

}  // namespace

Status validate(const PolygonMesh& mesh) {
  COIF_TRY(validateOffsets(mesh));
  for (std::size_t f = 0; f < mesh.faceCount(); ++f)
    for (std::uint32_t v : mesh.face(f))
      if (v >= mesh.vertexCount())
        return makeError(
            ErrorCode::Malformed,
            "A corner names vertex " + std::to_string(v) + " of " + std::to_string(mesh.vertexCount()) + ".",
            facePlace(f));
  for (std::size_t v = 0; v < mesh.vertexCount(); ++v)
    if (!mesh.positions[v].allFinite())
      return makeError(ErrorCode::Degenerate, "The position is not finite.", "vertex " + std::to_string(v));
  if (!mesh.cornerUvs.empty() && mesh.cornerUvs.size() != mesh.corners.size())
    return makeError(ErrorCode::Malformed, "There must be one UV a corner, or none.");
  if (!mesh.faceGroups.empty() && mesh.faceGroups.size() != mesh.faceCount())
    return makeError(ErrorCode::Malformed, "There must be one group a face, or none.");
  for (std::size_t f = 0; f < mesh.faceGroups.size(); ++f)
    if (mesh.faceGroups[f] >= mesh.groupNames.size())
      return makeError(ErrorCode::Malformed, "The face's group has no name.", facePlace(f));
  return {};
}

Box bounds(std::span<const Vec3> points) {
  Box box;
  if (points.empty()) return box;
  box.lo = box.hi = points[0];
  for (const Vec3& p : points) {
    box.lo = box.lo.cwiseMin(p);
    box.hi = box.hi.cwiseMax(p);
  }
  return box;
}

Vec3 newellNormal(std::span<const Vec3> polygon) {
  Vec3 sum = Vec3::Zero();
  // Relative to the first corner: no cancellation far from the origin.
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    sum += (polygon[i] - polygon[0]).cross(polygon[i + 1] - polygon[0]);
  return sum;
}

std::vector<Vec3> vertexNormals(const PolygonMesh& mesh) {
  std::vector<Vec3> normals(mesh.vertexCount(), Vec3::Zero());
  std::vector<Vec3> polygon;
  for (std::size_t f = 0; f < mesh.faceCount(); ++f) {
    const auto face = mesh.face(f);
    polygon.clear();
    for (const std::uint32_t v : face) polygon.push_back(mesh.positions[v]);
    const Vec3 normal = newellNormal(polygon);
    for (const std::uint32_t v : face) normals[v] += normal;
  }
  for (Vec3& n : normals) n = n.stableNormalized();
  return normals;
}

}  // namespace coif
