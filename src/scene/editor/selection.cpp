#include "coif/scene/selection.h"

#include <algorithm>
#include <optional>
#include <set>

#include "scene/editor/adjacency.h"

namespace coif {

using editor::Adjacency;
using editor::exists;

namespace {

template <class T>
void sortUnique(std::vector<T>& list) {
  std::ranges::sort(list);
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

template <class T>
std::vector<T> listOf(const std::set<T>& set) {
  return {set.begin(), set.end()};
}

std::span<const std::uint32_t> cornersOf(const HairMesh& mesh, FaceRef face) {
  return mesh.bundles()[mesh.indexOf(face.bundle)].face(face.layer);
}

std::vector<std::uint8_t> vertexFlags(const HairMesh& mesh, const Selection& selection) {
  std::vector<std::uint8_t> flags(mesh.vertices().size(), 0);
  for (std::uint32_t v : selectedVertices(mesh, selection)) flags[v] = 1;
  return flags;
}

/// Vertices, edges and faces that a test on vertex flags picks, of the kinds that `like` has.
template <class Test>
Selection pick(const Adjacency& adjacency, const Selection& like, const Test& test) {
  const HairMesh& mesh = adjacency.mesh();
  Selection out;
  if (!like.vertices.empty()) {
    for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
      const std::uint32_t corner[] = {v};
      if (test(std::span<const std::uint32_t>(corner))) out.vertices.push_back(mesh.vertices()[v].id);
    }
  }
  if (!like.edges.empty()) {
    for (const EdgeRef& edge : adjacency.edges()) {
      const auto [a, b] = adjacency.ends(edge);
      const std::uint32_t corners[] = {a, b};
      if (test(std::span<const std::uint32_t>(corners))) out.edges.push_back(edge);
    }
  }
  if (!like.faces.empty()) {
    for (const FaceRef& face : allOf(mesh, SelectKind::Face).faces) {
      if (test(cornersOf(mesh, face))) out.faces.push_back(face);
    }
  }
  return out;
}

/// The side of a quad opposite to this one.
std::optional<EdgeRef> across(const HairMesh& mesh, EdgeRef side) {
  if (mesh.bundles()[mesh.indexOf(side.bundle)].corners != 4) return std::nullopt;
  return EdgeRef{side.bundle, side.layer, (side.side + 2) % 4};
}

/// From an edge through one of its ends: the edge that goes on straight, which is the one that shares no face
/// with it, where four edges meet.
std::optional<EdgeRef> straightOn(const Adjacency& adjacency, EdgeRef edge, std::uint32_t through) {
  const auto& around = adjacency.neighbours(through);
  if (around.size() != 4 || adjacency.facesOf(through).size() != 4) return std::nullopt;
  std::set<FaceRef> beside;
  for (const EdgeRef& side : adjacency.sidesOf(edge)) beside.insert({side.bundle, side.layer});
  for (std::uint32_t next : around) {
    const auto& sides = adjacency.sidesOf(through, next);
    const bool apart = std::ranges::none_of(sides, [&](const EdgeRef& side) {
      return beside.contains({side.bundle, side.layer});
    });
    if (apart && !sides.empty()) return sides.front();
  }
  return std::nullopt;
}

}  // namespace

EdgeRef canonicalEdge(const HairMesh& mesh, EdgeRef edge) {
  return Adjacency(mesh).canonical(edge);
}

Selection keepValid(const HairMesh& mesh, Selection selection) {
  std::erase_if(selection.vertices, [&](VertexId id) { return mesh.indexOf(id) == kNone; });
  std::erase_if(selection.edges, [&](EdgeRef edge) { return !exists(mesh, edge); });
  std::erase_if(selection.faces, [&](FaceRef face) { return !exists(mesh, face); });
  if (!selection.edges.empty()) {
    const Adjacency adjacency(mesh);
    for (EdgeRef& edge : selection.edges) edge = adjacency.canonical(edge);
  }
  sortUnique(selection.vertices);
  sortUnique(selection.edges);
  sortUnique(selection.faces);
  return selection;
}

std::vector<std::uint32_t> selectedVertices(const HairMesh& mesh, const Selection& selection) {
  std::vector<std::uint32_t> out;
  for (VertexId id : selection.vertices) out.push_back(mesh.indexOf(id));
  for (const EdgeRef& edge : selection.edges) {
    const auto face = cornersOf(mesh, {edge.bundle, edge.layer});
    out.push_back(face[edge.side]);
    out.push_back(face[(edge.side + 1) % face.size()]);
  }
  for (const FaceRef& face : selection.faces) {
    const auto corners = cornersOf(mesh, face);
    out.insert(out.end(), corners.begin(), corners.end());
  }
  sortUnique(out);
  return out;
}

std::vector<FaceRef> selectedFaces(const HairMesh& mesh, const Selection& selection) {
  std::vector<FaceRef> out = selection.faces;
  if (!selection.vertices.empty()) {
    const auto flags = vertexFlags(mesh, {selection.vertices, {}, {}});
    for (const FaceRef& face : allOf(mesh, SelectKind::Face).faces) {
      if (std::ranges::all_of(cornersOf(mesh, face), [&](std::uint32_t v) { return flags[v]; }))
        out.push_back(face);
    }
  }
  sortUnique(out);
  return out;
}

std::vector<EdgeRef> selectedEdges(const HairMesh& mesh, const Selection& selection) {
  std::vector<EdgeRef> out = selection.edges;
  if (!selection.vertices.empty()) {
    const auto flags = vertexFlags(mesh, {selection.vertices, {}, {}});
    const Adjacency adjacency(mesh);
    for (const EdgeRef& edge : adjacency.edges()) {
      const auto [a, b] = adjacency.ends(edge);
      if (flags[a] && flags[b]) out.push_back(edge);
    }
  }
  sortUnique(out);
  return out;
}

std::vector<BundleId> selectedBundles(const HairMesh& mesh, const Selection& selection) {
  std::vector<BundleId> out;
  for (const FaceRef& face : selectedFaces(mesh, selection)) out.push_back(face.bundle);
  sortUnique(out);
  return out;
}

Selection allOf(const HairMesh& mesh, SelectKind kind, std::uint32_t layer) {
  Selection out;
  const auto wanted = [&](std::uint32_t l) { return layer == kNone || l == layer; };
  if (kind == SelectKind::Vertex) {
    for (const HairVertex& vertex : mesh.vertices()) {
      if (wanted(vertex.layer)) out.vertices.push_back(vertex.id);
    }
  } else if (kind == SelectKind::Edge) {
    for (const EdgeRef& edge : Adjacency(mesh).edges()) {
      if (wanted(edge.layer)) out.edges.push_back(edge);
    }
  } else {
    for (const Bundle& bundle : mesh.bundles()) {
      for (std::uint32_t l = 0; l <= bundle.height(); ++l) {
        if (wanted(l)) out.faces.push_back({bundle.id, l});
      }
    }
  }
  return out;
}

Selection inverted(const HairMesh& mesh, const Selection& selection, SelectKind kind) {
  const Selection all = allOf(mesh, kind);
  Selection out;
  std::ranges::set_difference(all.vertices, selection.vertices, std::back_inserter(out.vertices));
  std::ranges::set_difference(all.edges, selection.edges, std::back_inserter(out.edges));
  std::ranges::set_difference(all.faces, selection.faces, std::back_inserter(out.faces));
  return out;
}

Selection grown(const HairMesh& mesh, const Selection& selection) {
  const Adjacency adjacency(mesh);
  auto flags = vertexFlags(mesh, selection);
  Selection byVertex;
  for (std::uint32_t v = 0; v < flags.size(); ++v) {
    const bool reached = flags[v] || std::ranges::any_of(adjacency.neighbours(v),
                                                         [&](std::uint32_t n) { return flags[n] == 1; });
    if (reached && !selection.vertices.empty()) byVertex.vertices.push_back(mesh.vertices()[v].id);
  }
  Selection others = selection;
  others.vertices.clear();
  Selection out = pick(adjacency, others, [&](std::span<const std::uint32_t> corners) {
    return std::ranges::any_of(corners, [&](std::uint32_t v) { return flags[v] == 1; });
  });
  out.vertices = std::move(byVertex.vertices);
  return out;
}

Selection shrunk(const HairMesh& mesh, const Selection& selection) {
  const Adjacency adjacency(mesh);
  const auto keepsVertex = [&](VertexId id) {
    return std::ranges::all_of(adjacency.neighbours(mesh.indexOf(id)), [&](std::uint32_t n) {
      return std::ranges::binary_search(selection.vertices, mesh.vertices()[n].id);
    });
  };
  const auto facesAround = [&](std::span<const std::uint32_t> corners) {
    std::vector<FaceRef> faces;
    for (std::uint32_t v : corners) {
      faces.insert(faces.end(), adjacency.facesOf(v).begin(), adjacency.facesOf(v).end());
    }
    return faces;
  };
  Selection out;
  std::ranges::copy_if(selection.vertices, std::back_inserter(out.vertices), keepsVertex);
  std::ranges::copy_if(selection.faces, std::back_inserter(out.faces), [&](const FaceRef& face) {
    return std::ranges::all_of(facesAround(cornersOf(mesh, face)), [&](const FaceRef& other) {
      return std::ranges::binary_search(selection.faces, other);
    });
  });
  std::ranges::copy_if(selection.edges, std::back_inserter(out.edges), [&](const EdgeRef& edge) {
    const auto [a, b] = adjacency.ends(edge);
    for (std::uint32_t end : {a, b}) {
      for (std::uint32_t n : adjacency.neighbours(end)) {
        if (!std::ranges::binary_search(selection.edges, adjacency.sidesOf(end, n).front())) return false;
      }
    }
    return true;
  });
  return out;
}

Selection linked(const HairMesh& mesh, const Selection& selection) {
  const Adjacency adjacency(mesh);
  auto flags = vertexFlags(mesh, selection);
  std::vector<std::uint32_t> front = selectedVertices(mesh, selection);
  while (!front.empty()) {
    const std::uint32_t v = front.back();
    front.pop_back();
    for (std::uint32_t n : adjacency.neighbours(v)) {
      if (!flags[n]) flags[n] = 1, front.push_back(n);
    }
  }
  return pick(adjacency, selection, [&](std::span<const std::uint32_t> corners) {
    return std::ranges::all_of(corners, [&](std::uint32_t v) { return flags[v] == 1; });
  });
}

Selection widened(const HairMesh& mesh, Selection selection, SelectKind kind) {
  if (kind < SelectKind::Bundle || selection.faces.empty()) return selection;
  std::set<std::uint32_t> layers, groups;
  std::set<BundleId> bundles;
  for (const FaceRef& face : selection.faces) {
    layers.insert(face.layer), bundles.insert(face.bundle);
    groups.insert(mesh.bundles()[mesh.indexOf(face.bundle)].group);
  }
  selection.faces.clear();
  for (const Bundle& bundle : mesh.bundles()) {
    const bool whole = kind == SelectKind::Bundle
                           ? bundles.contains(bundle.id)
                           : kind == SelectKind::Group && groups.contains(bundle.group);
    for (std::uint32_t layer = 0; layer <= bundle.height(); ++layer) {
      if (whole || (kind == SelectKind::Layer && layers.contains(layer)))
        selection.faces.push_back({bundle.id, layer});
    }
  }
  return selection;
}

Selection columns(const HairMesh& mesh, const Selection& selection) {
  Selection out;
  std::vector<std::uint8_t> roots(mesh.vertices().size(), 0);
  const auto rootOf = [&](std::uint32_t v) {
    while (mesh.vertices()[v].parent != kNone) v = mesh.vertices()[v].parent;
    return v;
  };
  for (VertexId id : selection.vertices) roots[rootOf(mesh.indexOf(id))] = 1;
  for (std::uint32_t v = 0; v < roots.size(); ++v) {
    if (roots[rootOf(v)]) out.vertices.push_back(mesh.vertices()[v].id);
  }
  for (const EdgeRef& edge : selection.edges) {
    const Bundle& bundle = mesh.bundles()[mesh.indexOf(edge.bundle)];
    for (std::uint32_t l = 0; l <= bundle.height(); ++l) out.edges.push_back({edge.bundle, l, edge.side});
  }
  for (const FaceRef& face : selection.faces) {
    const Bundle& bundle = mesh.bundles()[mesh.indexOf(face.bundle)];
    for (std::uint32_t l = 0; l <= bundle.height(); ++l) out.faces.push_back({face.bundle, l});
  }
  return keepValid(mesh, std::move(out));
}

std::vector<EdgeRef> edgeLoop(const HairMesh& mesh, EdgeRef start) {
  const Adjacency adjacency(mesh);
  std::set<EdgeRef> loop{adjacency.canonical(start)};
  const auto [first, second] = adjacency.ends(start);
  for (std::uint32_t end : {first, second}) {
    EdgeRef edge = adjacency.canonical(start);
    while (const auto next = straightOn(adjacency, edge, end)) {
      if (!loop.insert(*next).second) break;
      const auto [a, b] = adjacency.ends(*next);
      end = a == end ? b : a;
      edge = *next;
    }
  }
  return listOf(loop);
}

std::vector<EdgeRef> edgeRing(const HairMesh& mesh, EdgeRef start) {
  const Adjacency adjacency(mesh);
  std::set<EdgeRef> ring{adjacency.canonical(start)};
  for (EdgeRef side : adjacency.sidesOf(start)) {
    while (const auto opposite = across(mesh, side)) {
      if (!ring.insert(adjacency.canonical(*opposite)).second) break;
      const auto& sides = adjacency.sidesOf(*opposite);
      const auto other =
          std::ranges::find_if(sides, [&](const EdgeRef& s) { return s.bundle != opposite->bundle; });
      if (other == sides.end()) break;
      side = *other;
    }
  }
  return listOf(ring);
}

}  // namespace coif
