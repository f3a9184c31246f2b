#include "coif/hairmesh/edit.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "hairmesh/select.h"

namespace coif {
namespace {

using namespace hairmesh;

Status checkVertex(const HairMesh& mesh, std::uint32_t v) {
  if (v < mesh.vertices().size()) return {};
  return makeError(ErrorCode::NotFound, "the mesh has no such vertex", "vertex index " + std::to_string(v));
}

Status checkWeights(const HairMesh& mesh, const VertexWeights& weights) {
  if (weights.size() != mesh.vertices().size()) return refuse("there must be one weight a vertex", "weights");
  for (std::size_t v = 0; v < weights.size(); ++v) {
    if (!(weights[v] >= 0 && weights[v] <= 1)) {
      return refuse("the weight is not between 0 and 1", placeOf(mesh.vertices()[v].id));
    }
  }
  return {};
}

/// Moves every vertex of weight > 0 to place(position, weight), or none when a result is not finite.
template <class Place>
Status moveAll(HairMesh& mesh, const VertexWeights& weights, Place place) {
  COIF_TRY(checkWeights(mesh, weights));
  std::vector<Vec3> moved(weights.size());
  for (std::uint32_t v = 0; v < weights.size(); ++v) {
    moved[v] = weights[v] > 0 ? place(mesh.position(v), weights[v]) : mesh.position(v);
    if (!moved[v].allFinite())
      return refuse("the move leaves a position not finite", placeOf(mesh.vertices()[v].id));
  }
  for (std::uint32_t v = 0; v < weights.size(); ++v) mesh.setPosition(v, moved[v]);
  return {};
}

std::vector<std::uint32_t> marked(const std::vector<std::uint8_t>& marks) {
  std::vector<std::uint32_t> result;
  for (std::uint32_t i = 0; i < marks.size(); ++i) {
    if (marks[i]) result.push_back(i);
  }
  return result;
}

}  // namespace

std::vector<std::uint32_t> verticesOfLayer(const HairMesh& mesh, std::uint32_t layer) {
  std::vector<std::uint32_t> result;
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
    if (mesh.vertices()[v].layer == layer) result.push_back(v);
  }
  return result;
}

Result<std::vector<std::uint32_t>> verticesOfBundle(const HairMesh& mesh, BundleId id, std::uint32_t layer) {
  COIF_ASSIGN(const std::uint32_t j, selectFace(mesh, {id, layer == kNone ? 0 : layer}));
  const Bundle& bundle = mesh.bundles()[j];
  std::vector<std::uint32_t> result = bundle.vertices;
  if (layer != kNone) result.assign(bundle.face(layer).begin(), bundle.face(layer).end());
  std::sort(result.begin(), result.end());
  return result;
}

Result<std::vector<std::uint32_t>> columnOf(const HairMesh& mesh, std::uint32_t vertex) {
  COIF_TRY(checkVertex(mesh, vertex));
  const auto all = mesh.vertices();
  std::vector<std::uint8_t> chosen(all.size(), 0);
  for (std::uint32_t v = vertex; v != kNone; v = all[v].parent) chosen[v] = 1;
  for (std::uint32_t start = 0; start < all.size(); ++start) {
    std::uint32_t v = start;
    while (v != kNone && all[v].layer > all[vertex].layer) v = all[v].parent;
    if (v == vertex) chosen[start] = 1;
  }
  return marked(chosen);
}

Result<std::vector<std::uint32_t>> connectedBundles(const HairMesh& mesh, BundleId bundle,
                                                    std::uint32_t layer) {
  COIF_ASSIGN(const std::uint32_t start, selectFace(mesh, {bundle, layer}));
  COIF_ASSIGN(const Topology topology,
              Topology::build(mesh.vertices().size(), mesh.bundles(), mesh.splits()));
  std::vector<std::uint8_t> reached(mesh.bundles().size(), 0);
  std::vector<std::uint32_t> open{start};
  reached[start] = 1;
  while (!open.empty()) {
    const std::uint32_t j = open.back();
    open.pop_back();
    for (std::uint32_t i = 0; i < mesh.bundles()[j].corners; ++i) {
      if (!topology.joined(mesh.bundles(), topology.side(j, i), layer)) continue;
      const std::uint32_t other = topology.bundleOf(topology.opposite(topology.side(j, i)));
      if (!reached[other]++) open.push_back(other);
    }
  }
  return marked(reached);
}

Result<std::vector<std::uint32_t>> quadStrip(const HairMesh& mesh, EdgeRef edge) {
  COIF_ASSIGN(const std::uint32_t start, selectEdge(mesh, edge));
  COIF_ASSIGN(const Topology t, Topology::build(mesh.vertices().size(), mesh.bundles(), mesh.splits()));
  const auto isQuad = [&](std::uint32_t j) { return mesh.bundles()[j].corners == 4; };
  std::vector<std::uint32_t> strip{start};
  if (!isQuad(start)) return strip;
  /// Leaves the last face by `side` for as long as quads follow; true when the strip closes.
  const auto follow = [&](std::uint32_t side, std::vector<std::uint32_t>& faces) {
    while (t.opposite(side) != kNone && isQuad(t.bundleOf(t.opposite(side)))) {
      const std::uint32_t entered = t.opposite(side), j = t.bundleOf(entered);
      if (j == start) return true;
      if (std::ranges::find(faces, j) != faces.end()) break;  // a strip that crosses itself
      faces.push_back(j);
      side = t.next(t.next(entered));
    }
    return false;
  };
  const std::uint32_t out = t.side(start, edge.side);
  if (follow(out, strip)) return strip;
  std::vector<std::uint32_t> back;
  follow(t.next(t.next(out)), back);
  std::erase_if(back, [&](std::uint32_t j) { return std::ranges::find(strip, j) != strip.end(); });
  strip.insert(strip.begin(), back.rbegin(), back.rend());
  return strip;
}

Status translate(HairMesh& mesh, const VertexWeights& weights, const Vec3& by) {
  return moveAll(mesh, weights, [&](const Vec3& p, double w) -> Vec3 { return p + w * by; });
}

Status scale(HairMesh& mesh, const VertexWeights& weights, const Vec3& pivot, const Vec3& factors,
             const Mat3& axes) {
  if (!((axes.transpose() * axes - Mat3::Identity()).cwiseAbs().maxCoeff() < 1e-6))
    return refuse("the axes are not unit vectors at right angles", "axes");
  if (axes == Mat3::Identity()) {
    return moveAll(mesh, weights, [&](const Vec3& p, double w) -> Vec3 {
      return p + w * ((p - pivot).cwiseProduct(factors) - (p - pivot));
    });
  }
  const Mat3 stretch = axes * (factors - Vec3::Ones()).asDiagonal() * axes.transpose();
  return moveAll(mesh, weights,
                 [&](const Vec3& p, double w) -> Vec3 { return p + w * (stretch * (p - pivot)); });
}

Status rotate(HairMesh& mesh, const VertexWeights& weights, const Vec3& pivot, const Vec3& axis,
              double angleRad) {
  const double length = axis.norm();
  if (!(length > 0) || !std::isfinite(length)) return refuse("the axis has no direction", "axis");
  const Vec3 unit = axis / length;
  return moveAll(mesh, weights, [&](const Vec3& p, double w) -> Vec3 {
    return pivot + Eigen::AngleAxisd(w * angleRad, unit) * (p - pivot);
  });
}

Status smooth(HairMesh& mesh, const VertexWeights& weights, double strength, int steps) {
  COIF_TRY(checkWeights(mesh, weights));
  if (!(strength >= 0 && strength <= 1)) return refuse("the strength is not between 0 and 1", "strength");
  if (steps < 0) return refuse("the number of steps is negative", "steps");
  COIF_ASSIGN(const Topology t, Topology::build(mesh.vertices().size(), mesh.bundles(), mesh.splits()));
  // Every edge of every layer once; border vertices take part in border edges only.
  struct Edge {
    std::uint32_t a, b;
    bool border;
  };
  std::vector<Edge> edges;
  std::vector<std::uint8_t> border(mesh.vertices().size(), 0);
  for (std::uint32_t side = 0; side < t.sideCount(); ++side) {
    const Bundle& bundle = mesh.bundles()[t.bundleOf(side)];
    for (std::uint32_t k = 0; k <= bundle.height(); ++k) {
      const bool joined = t.joined(mesh.bundles(), side, k);
      if (joined && t.opposite(side) < side) continue;
      const Edge edge{bundle.face(k)[t.cornerOf(side)], bundle.face(k)[t.cornerOf(t.next(side))], !joined};
      if (!joined) border[edge.a] = border[edge.b] = 1;
      edges.push_back(edge);
    }
  }
  for (int step = 0; step < steps; ++step) {
    std::vector<Vec3> sum(mesh.vertices().size(), Vec3::Zero());
    std::vector<double> count(mesh.vertices().size(), 0);
    for (const Edge& e : edges) {
      if (e.border || !border[e.a]) sum[e.a] += mesh.position(e.b), count[e.a] += 1;
      if (e.border || !border[e.b]) sum[e.b] += mesh.position(e.a), count[e.b] += 1;
    }
    for (std::uint32_t v = 0; v < sum.size(); ++v) {
      const Vec3 p = mesh.position(v);
      if (count[v] > 0) mesh.setPosition(v, p + strength * weights[v] * (sum[v] / count[v] - p));
    }
  }
  return {};
}

}  // namespace coif
