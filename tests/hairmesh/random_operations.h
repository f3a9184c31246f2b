// Random operations that mostly succeed, for walks through the space of hair meshes.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "coif/base/random.h"
#include "coif/hairmesh/operations.h"

namespace coif {

/// A stream of draws and the random choices the walk makes with them.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed, 7) {}
  std::uint32_t below(std::size_t n) { return random_.below(counter_++, std::uint32_t(n)); }
  double uniform() { return random_.uniform(counter_++); }
  double inside() { return 0.05 + 0.9 * uniform(); }

 private:
  CounterRandom random_;
  std::uint64_t counter_ = 0;
};

/// A bundle and some of its neighbours by root vertices: what an artist selects.
inline std::vector<BundleId> patch(const HairMesh& mesh, Draw& draw, std::size_t size) {
  std::vector<BundleId> ids{mesh.bundles()[draw.below(mesh.bundles().size())].id};
  for (std::size_t i = 0; i < ids.size() && ids.size() < size; ++i) {
    const auto face = mesh.bundles()[mesh.indexOf(ids[i])].face(0);
    for (const Bundle& other : mesh.bundles()) {
      const bool touches = std::ranges::any_of(
          other.face(0), [&](std::uint32_t v) { return std::ranges::find(face, v) != face.end(); });
      if (touches && ids.size() < size && std::ranges::find(ids, other.id) == ids.end())
        ids.push_back(other.id);
    }
  }
  return ids;
}

inline FaceRef anyFace(const HairMesh& mesh, Draw& draw) {
  const Bundle& bundle = mesh.bundles()[draw.below(mesh.bundles().size())];
  return {bundle.id, draw.below(bundle.height() + 1)};
}

inline EdgeRef anyEdge(const HairMesh& mesh, Draw& draw) {
  const Bundle& bundle = mesh.bundles()[draw.below(mesh.bundles().size())];
  const std::uint32_t side = draw.below(bundle.corners);
  return {bundle.id, draw.below(bundle.height() + 1), side};
}

/// The other side of a split root edge, on its first separate layer or above.
inline std::pair<EdgeRef, EdgeRef> anySplit(const HairMesh& mesh, Draw& draw) {
  if (mesh.splits().empty()) return {anyEdge(mesh, draw), anyEdge(mesh, draw)};
  const EdgeSplit split = mesh.splits()[draw.below(mesh.splits().size())];
  std::vector<EdgeRef> sides;
  std::uint32_t low = kNone;
  for (const Bundle& bundle : mesh.bundles()) {
    const auto face = bundle.face(0);
    for (std::uint32_t i = 0; i < bundle.corners; ++i) {
      const auto [a, b] = std::minmax(face[i], face[(i + 1) % bundle.corners]);
      if (a != split.a || b != split.b) continue;
      sides.push_back({bundle.id, 0, i});
      low = std::min(low, bundle.height());
    }
  }
  const std::uint32_t layer = split.layer + draw.below(low - split.layer + 1);
  sides[0].layer = sides[1].layer = layer;
  if (draw.below(2)) std::swap(sides[0], sides[1]);
  return {sides[0], sides[1]};
}

/// Two vertices of one layer over one root vertex, where the draw finds such.
inline std::pair<VertexId, VertexId> anyPair(const HairMesh& mesh, Draw& draw) {
  const auto rootOf = [&](std::uint32_t v) {
    while (mesh.vertices()[v].parent != kNone) v = mesh.vertices()[v].parent;
    return v;
  };
  const std::uint32_t start = draw.below(mesh.vertices().size());
  for (std::uint32_t step = 0; step < mesh.vertices().size(); ++step) {
    const std::uint32_t v = (start + step) % std::uint32_t(mesh.vertices().size());
    if (mesh.vertices()[v].layer == 0) continue;
    for (std::uint32_t w = v + 1; w < mesh.vertices().size(); ++w) {
      if (mesh.vertices()[w].layer == mesh.vertices()[v].layer && rootOf(w) == rootOf(v)) {
        return {mesh.vertices()[v].id, mesh.vertices()[w].id};
      }
    }
    if (step > 20) break;
  }
  return {mesh.vertices()[start].id, mesh.vertices()[0].id};
}

struct Kind {
  const char* name;
  std::uint32_t weight;        ///< how often it is drawn
  std::uint32_t shrinkWeight;  ///< while the mesh is too large
  std::uint32_t growWeight;    ///< while it is too small
};
constexpr Kind kKinds[] = {{"extrude", 3, 0, 8},    {"delete", 2, 6, 0},       {"insert", 2, 0, 2},
                           {"remove", 2, 4, 0},     {"separateEdge", 8, 2, 2}, {"separateVertex", 4, 1, 1},
                           {"weldEdges", 4, 1, 1},  {"weldVertices", 6, 1, 1}, {"divideFace", 3, 0, 1},
                           {"divideEdge", 2, 0, 1}, {"dissolveEdge", 3, 4, 0}, {"dissolveVertex", 3, 3, 0},
                           {"subdivide", 1, 0, 1},  {"loop", 1, 0, 1},         {"move", 2, 1, 1}};

/// Draws again, a few times, while `poor` says that the choice would be refused: most, not all, should
/// succeed.
template <class Pick, class Poor>
auto pickWell(Pick pick, Poor poor) {
  auto choice = pick();
  for (int i = 0; i < 12 && poor(choice); ++i) choice = pick();
  return choice;
}

inline Status status(const Result<Created>& result) {
  if (result.ok()) return {};
  return result.error();
}

inline FaceRef anyUpperFace(const HairMesh& mesh, Draw& draw) {
  return pickWell([&] { return anyFace(mesh, draw); }, [](const FaceRef& f) { return f.layer == 0; });
}

inline bool hasNeighbour(const HairMesh& mesh, EdgeRef edge) {
  const auto ends = [&](const Bundle& b, std::uint32_t i) {
    const auto face = b.face(edge.layer);
    return std::minmax({face[i], face[(i + 1) % b.corners]});  // by value
  };
  const auto wanted = ends(mesh.bundles()[mesh.indexOf(edge.bundle)], edge.side);
  return std::ranges::any_of(mesh.bundles(), [&](const Bundle& b) {
    if (b.id == edge.bundle || b.height() < edge.layer) return false;
    for (std::uint32_t i = 0; i < b.corners; ++i) {
      if (ends(b, i) == wanted) return true;
    }
    return false;
  });
}

inline EdgeRef anySharedEdge(const HairMesh& mesh, Draw& draw, bool upper) {
  return pickWell([&] { return anyEdge(mesh, draw); },
                  [&](const EdgeRef& e) { return (upper && e.layer == 0) || !hasNeighbour(mesh, e); });
}

/// A root vertex between two edges, where the draws find one.
inline VertexId anyPassingVertex(const HairMesh& mesh, Draw& draw) {
  const std::uint32_t v = pickWell([&] { return draw.below(mesh.vertices().size()); },
                                   [&](std::uint32_t x) {
                                     std::size_t faces = 0;
                                     for (const Bundle& b : mesh.bundles())
                                       faces += std::ranges::count(b.face(0), x);
                                     return faces != 1 && faces != 2;
                                   });
  return mesh.vertices()[v].id;
}

inline BundleId anyTriangle(const HairMesh& mesh, Draw& draw) {
  const std::uint32_t start = draw.below(mesh.bundles().size());
  for (std::uint32_t i = 0; i < mesh.bundles().size(); ++i) {
    const Bundle& bundle = mesh.bundles()[(start + i) % mesh.bundles().size()];
    if (bundle.corners == 3) return bundle.id;
  }
  return mesh.bundles()[start].id;
}

/// One random operation of a kind, done or refused.
inline Status randomOperation(HairMesh& mesh, std::size_t kind, Draw& draw, double size) {
  const std::string name = kKinds[kind].name;
  if (name == "extrude")
    return status(extrudeFaces(mesh, patch(mesh, draw, 1 + draw.below(40)), {.distance = size}));
  if (name == "delete") return status(deleteFaces(mesh, patch(mesh, draw, 1 + draw.below(3))));
  if (name == "insert") return status(insertLayer(mesh, anyUpperFace(mesh, draw), draw.inside()));
  if (name == "remove") return status(removeLayer(mesh, anyUpperFace(mesh, draw)));
  if (name == "separateEdge") return status(separateEdge(mesh, anySharedEdge(mesh, draw, true)));
  if (name == "separateVertex") {
    return status(separateVertex(mesh, mesh.vertices()[draw.below(mesh.vertices().size())].id));
  }
  if (name == "weldEdges") {
    const auto [a, b] = anySplit(mesh, draw);
    return status(weldEdges(mesh, a, b, draw.below(2) ? WeldPosition::Average : WeldPosition::First));
  }
  if (name == "weldVertices") {
    const auto [a, b] = anyPair(mesh, draw);
    return status(weldVertices(mesh, a, b));
  }
  if (name == "divideFace") {
    const Bundle& bundle = mesh.bundles()[draw.below(mesh.bundles().size())];
    FacePoint from{draw.below(bundle.corners), 0}, to{draw.below(bundle.corners), 0};
    if (draw.below(4) == 0) from.t = draw.inside();
    if (draw.below(4) == 0) to.t = draw.inside();
    return status(divideFace(mesh, bundle.id, from, to));
  }
  if (name == "divideEdge") return status(divideEdge(mesh, anyEdge(mesh, draw), draw.inside()));
  if (name == "dissolveEdge") return status(dissolveEdge(mesh, anySharedEdge(mesh, draw, false)));
  if (name == "dissolveVertex") {
    return status(dissolveVertex(mesh, anyPassingVertex(mesh, draw)));
  }
  if (name == "subdivide") return status(subdivide(mesh, patch(mesh, draw, 1 + draw.below(3))));
  if (name == "loop")
    return status(subdivide(mesh, std::vector{anyTriangle(mesh, draw)}, SubdivisionScheme::Loop));
  const std::uint32_t v = draw.below(mesh.vertices().size());
  mesh.setPosition(
      v, mesh.position(v) + size * Vec3(draw.uniform() - 0.5, draw.uniform() - 0.5, draw.uniform() - 0.5));
  if (draw.below(8) == 0) mesh.setPinned(v, !mesh.vertices()[v].pinned);
  return {};
}

/// Steers the walk: above the upper number of faces mostly what shrinks, below the lower what grows.
inline std::size_t chooseKind(const HairMesh& mesh, Draw& draw, std::size_t lower, std::size_t upper) {
  std::size_t faces = 0;
  for (const Bundle& bundle : mesh.bundles()) faces += bundle.height() + 1;
  const auto weight = [&](const Kind& kind) {
    return faces > upper ? kind.shrinkWeight : faces < lower ? kind.growWeight : kind.weight;
  };
  std::uint32_t total = 0;
  for (const Kind& kind : kKinds) total += weight(kind);
  std::uint32_t pick = draw.below(total);
  std::size_t chosen = 0;
  while (pick >= weight(kKinds[chosen])) pick -= weight(kKinds[chosen++]);
  return chosen;
}

}  // namespace coif
