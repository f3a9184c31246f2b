// Soft selections and the normals of the hair's outside.
#include <algorithm>
#include <cmath>
#include <queue>

#include "coif/hairmesh/edit.h"
#include "coif/scalp/polygon_mesh.h"
#include "hairmesh/hull.h"
#include "hairmesh/select.h"

namespace coif {
namespace {

using namespace hairmesh;

constexpr double kFar = 1e300;

struct Graph {
  std::vector<std::vector<std::uint32_t>> neighbours;
  explicit Graph(std::size_t vertices) : neighbours(vertices) {}
  void join(std::uint32_t a, std::uint32_t b) { neighbours[a].push_back(b), neighbours[b].push_back(a); }
};

Graph surfaceGraph(const HairMesh& mesh) {
  Graph graph(mesh.vertices().size());
  for (const Bundle& bundle : mesh.bundles()) {
    for (std::uint32_t k = 0; k <= bundle.height(); ++k) {
      const auto face = bundle.face(k);
      for (std::uint32_t i = 0; i < bundle.corners; ++i) graph.join(face[i], face[(i + 1) % bundle.corners]);
      if (bundle.corners == 4) graph.join(face[0], face[2]), graph.join(face[1], face[3]);
    }
  }
  for (const SideQuad& q : sideQuads(mesh)) {
    graph.join(q.a, q.c), graph.join(q.b, q.d), graph.join(q.a, q.d), graph.join(q.b, q.c);
  }
  return graph;
}

/// Dijkstra from the selection, up to `radius`.
std::vector<double> distancesAlong(const HairMesh& mesh, std::span<const std::uint32_t> selection,
                                   double radius) {
  const Graph graph = surfaceGraph(mesh);
  std::vector<double> distance(mesh.vertices().size(), kFar);
  using Entry = std::pair<double, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  for (std::uint32_t v : selection) distance[v] = 0, open.push({0, v});
  while (!open.empty()) {
    const auto [d, v] = open.top();
    open.pop();
    if (d > distance[v]) continue;
    for (std::uint32_t n : graph.neighbours[v]) {
      const double further = d + (mesh.position(n) - mesh.position(v)).norm();
      if (further < distance[n] && further < radius) distance[n] = further, open.push({further, n});
    }
  }
  return distance;
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
