// Soft selections, the normals of the hair's outside, and the axes of a selection.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "coif/hairmesh/edit.h"
#include "coif/scalp/geodesic.h"
#include "coif/scalp/polygon_mesh.h"
#include "hairmesh/hull.h"
#include "hairmesh/select.h"

namespace coif {
namespace {

using namespace hairmesh;

constexpr double kFar = 1e300;

using Triangle = std::array<std::uint32_t, 3>;

/// Every face of every layer and every side of every bundle: quads by both diagonals, so that neither side of
/// a mirror is favoured; other faces as fans.
std::vector<Triangle> surfaceTriangles(const HairMesh& mesh) {
  std::vector<Triangle> out;
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    out.insert(out.end(), {{a, b, c}, {a, c, d}, {a, b, d}, {b, c, d}});
  };
  for (const Bundle& bundle : mesh.bundles()) {
    for (std::uint32_t k = 0; k <= bundle.height(); ++k) {
      const auto face = bundle.face(k);
      if (bundle.corners == 4) {
        quad(face[0], face[1], face[2], face[3]);
        continue;
      }
      for (std::uint32_t i = 1; i + 1 < bundle.corners; ++i) out.push_back({face[0], face[i], face[i + 1]});
    }
  }
  for (const SideQuad& q : sideQuads(mesh)) quad(q.a, q.b, q.d, q.c);
  return out;
}

std::vector<double> distancesAlong(const HairMesh& mesh, std::span<const std::uint32_t> selection,
                                   double radius) {
  std::vector<Vec3> positions;
  for (const HairVertex& vertex : mesh.vertices()) positions.push_back(vertex.position);
  return geodesicDistances(positions, surfaceTriangles(mesh), selection, radius);
}

std::vector<double> distancesInSpace(const HairMesh& mesh, std::span<const std::uint32_t> selection) {
  std::vector<double> distance(mesh.vertices().size(), kFar);
  for (std::uint32_t v = 0; v < distance.size(); ++v) {
    for (const std::uint32_t s : selection) {
      distance[v] = std::min(distance[v], (mesh.position(v) - mesh.position(s)).norm());
    }
  }
  return distance;
}

}  // namespace

double falloffAt(Falloff falloff, double distance) {
  const double s = 1 - std::clamp(distance, 0.0, 1.0);
  switch (falloff) {
    case Falloff::Smooth:
      return s * s * (3 - 2 * s);
    case Falloff::Linear:
      return s;
    case Falloff::Sharp:
      return s * s;
    case Falloff::Round:
      return std::sqrt(2 * s - s * s);
    case Falloff::Constant:
      break;
  }
  return distance < 1 ? 1 : 0;
}

Result<VertexWeights> softSelection(const HairMesh& mesh, std::span<const std::uint32_t> selection,
                                    double radius, Falloff falloff, SoftDistance kind) {
  if (!(radius >= 0) || !std::isfinite(radius))
    return refuse("the radius is negative or not finite", "radius");
  VertexWeights weights(mesh.vertices().size(), 0);
  for (const std::uint32_t v : selection) {
    if (v >= weights.size()) {
      return makeError(ErrorCode::NotFound, "the mesh has no such vertex",
                       "vertex index " + std::to_string(v));
    }
  }
  if (radius > 0) {
    const auto distance = kind == SoftDistance::Space ? distancesInSpace(mesh, selection)
                                                      : distancesAlong(mesh, selection, radius);
    for (std::size_t v = 0; v < weights.size(); ++v) weights[v] = falloffAt(falloff, distance[v] / radius);
  }
  for (const std::uint32_t v : selection) weights[v] = 1;
  return weights;
}

std::vector<Vec3> hullNormals(const HairMesh& mesh) {
  return hairmesh::hullNormals(mesh, sideQuads(mesh));
}

Mat3 selectionAxes(const HairMesh& mesh, std::span<const std::uint32_t> vertices, AxesKind kind) {
  if (kind == AxesKind::World || vertices.empty()) return Mat3::Identity();
  std::vector<std::uint8_t> chosen(mesh.vertices().size(), 0);
  for (const std::uint32_t v : vertices) chosen[v] = 1;
  const std::vector<Vec3> normals = hullNormals(mesh);
  Vec3 hair = Vec3::Zero(), normal = Vec3::Zero();
  for (std::uint32_t v = 0; v < chosen.size(); ++v) {
    const std::uint32_t parent = mesh.vertices()[v].parent;
    const bool ofRoot = parent != kNone && chosen[parent] && mesh.vertices()[parent].layer == 0;
    // A root has no link down; the one up from it stands for its own.
    if (parent != kNone && (chosen[v] || ofRoot))
      hair += (mesh.position(v) - mesh.position(parent)).normalized();
    if (chosen[v]) normal += normals[v];
  }
  Mat3 axes;
  Vec3 y = kind == AxesKind::Hair ? hair : normal, z = kind == AxesKind::Hair ? normal : hair;
  if (!(y.norm() > 1e-9)) y = kind == AxesKind::Hair ? Vec3::UnitY() : Vec3::UnitZ();
  y.normalize();
  z -= z.dot(y) * y;
  if (!(z.norm() > 1e-9)) {  // no second direction: the scene's axis that is least along the first
    int least = 0;
    y.cwiseAbs().minCoeff(&least);
    z = Vec3::Unit(least) - y[least] * y;
  }
  z.normalize();
  if (kind == AxesKind::Normal) std::swap(y, z);
  axes << y.cross(z), y, z;
  return axes;
}

namespace hairmesh {

std::vector<Vec3> hullNormals(const HairMesh& mesh, std::span<const SideQuad> quads) {
  std::vector<Vec3> sides(mesh.vertices().size(), Vec3::Zero()), tips = sides;
  for (const SideQuad& q : quads) {
    if (!q.exposed) continue;
    // Corners run so that the bundle is to the left of a → b seen from its tip: a, b, d, c from outside.
    const Vec3 normal =
        (mesh.position(q.d) - mesh.position(q.a)).cross(mesh.position(q.c) - mesh.position(q.b));
    for (std::uint32_t v : {q.a, q.b, q.c, q.d}) sides[v] += normal;
  }
  for (const Bundle& bundle : mesh.bundles()) {
    std::vector<Vec3> polygon;
    const auto face = bundle.face(bundle.height());
    for (std::uint32_t v : face) polygon.push_back(mesh.position(v));
    const Vec3 normal = newellNormal(polygon);
    for (std::uint32_t v : face) tips[v] += normal;
  }
  for (std::size_t v = 0; v < sides.size(); ++v) {
    const Vec3& sum = sides[v].isZero(0) ? tips[v] : sides[v];
    sides[v] = sum.norm() > 0 ? Vec3(sum.normalized()) : Vec3(Vec3::Zero());
  }
  return sides;
}

}  // namespace hairmesh
}  // namespace coif
