// Meshes that the hairmesh tests start from.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "coif/hairmesh/hair_mesh.h"
#include "coif/hairmesh/invariants.h"
#include "coif/io/mesh_io.h"

namespace coif {

/// nx × ny unit quads in the plane z = 0, row by row; vertex (x, y) is y (nx + 1) + x.
inline HairMesh gridMesh(std::uint32_t nx, std::uint32_t ny) {
  std::vector<Vec3> positions;
  for (std::uint32_t y = 0; y <= ny; ++y) {
    for (std::uint32_t x = 0; x <= nx; ++x) positions.emplace_back(x, y, 0);
  }
  std::vector<std::uint32_t> offsets{0}, corners;
  for (std::uint32_t y = 0; y < ny; ++y) {
    for (std::uint32_t x = 0; x < nx; ++x) {
      const std::uint32_t a = y * (nx + 1) + x;
      corners.insert(corners.end(), {a, a + 1, a + nx + 2, a + nx + 1});
      offsets.push_back(std::uint32_t(corners.size()));
    }
  }
  return HairMesh::fromRoot(positions, offsets, corners).value();
}

/// The grid bent over the upper half of a unit sphere (equal-area on the disc, so no vertex repeats).
inline HairMesh capMesh(std::uint32_t n) {
  HairMesh mesh = gridMesh(n, n);
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
    const Vec3 p = mesh.position(v);
    const double x = 2 * p.x() / n - 1, y = 2 * p.y() / n - 1;
    const double u = x * std::sqrt(1 - y * y / 2), w = y * std::sqrt(1 - x * x / 2);
    mesh.setPosition(v, {u, w, std::sqrt(std::max(0.0, 1 - u * u - w * w))});
  }
  return mesh;
}

inline std::filesystem::path headPath(const std::string& name) {
  return std::filesystem::path(COIF_SHARED_DATA) / "heads" / name;
}

/// The faces of a polygon file whose middle is wanted, as a root layer.
inline HairMesh headMesh(const std::string& name, const std::function<bool(const Vec3&)>& wanted) {
  const PolygonMesh polygons = loadPolygonMesh(headPath(name)).value();
  PolygonMesh chosen;
  chosen.positions = polygons.positions;
  for (std::size_t f = 0; f < polygons.faceCount(); ++f) {
    Vec3 middle = Vec3::Zero();
    for (const std::uint32_t v : polygons.face(f))
      middle += polygons.positions[v] / double(polygons.face(f).size());
    if (wanted(middle)) chosen.addFace(polygons.face(f));
  }
  return HairMesh::fromRoot(chosen.positions, chosen.faceOffsets, chosen.corners).value();
}

inline std::vector<BundleId> allBundles(const HairMesh& mesh) {
  std::vector<BundleId> ids;
  for (const Bundle& bundle : mesh.bundles()) ids.push_back(bundle.id);
  return ids;
}

inline void expectSound(const HairMesh& mesh) {
  for (const InvariantFault& fault : checkInvariants(mesh)) {
    ADD_FAILURE() << fault.name << ": " << fault.element << ": " << fault.message;
  }
}

}  // namespace coif
