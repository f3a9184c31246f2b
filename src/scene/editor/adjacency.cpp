#include "scene/editor/adjacency.h"

#include <algorithm>

namespace coif::editor {

Adjacency::Adjacency(const HairMesh& mesh)
    : mesh_(mesh), neighbours_(mesh.vertices().size()), faces_(mesh.vertices().size()) {
  for (const Bundle& bundle : mesh.bundles()) {
    for (std::uint32_t layer = 0; layer <= bundle.height(); ++layer) {
      const auto face = bundle.face(layer);
      for (std::uint32_t i = 0; i < bundle.corners; ++i) {
        const std::uint32_t a = face[i], b = face[(i + 1) % bundle.corners];
        sides_[std::minmax(a, b)].push_back({bundle.id, layer, i});
        neighbours_[a].push_back(b);
        neighbours_[b].push_back(a);
        faces_[a].push_back({bundle.id, layer});
      }
    }
  }
  for (auto& list : neighbours_) {
    std::ranges::sort(list);
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
}

const std::vector<EdgeRef>& Adjacency::sidesOf(std::uint32_t a, std::uint32_t b) const {
  static const std::vector<EdgeRef> none;
  const auto found = sides_.find(std::minmax(a, b));
  return found == sides_.end() ? none : found->second;
}

const std::vector<EdgeRef>& Adjacency::sidesOf(EdgeRef edge) const {
  const auto [a, b] = ends(edge);
  return sidesOf(a, b);
}

std::pair<std::uint32_t, std::uint32_t> Adjacency::ends(EdgeRef edge) const {
  const Bundle& bundle = mesh_.bundles()[mesh_.indexOf(edge.bundle)];
  const auto face = bundle.face(edge.layer);
  return {face[edge.side], face[(edge.side + 1) % bundle.corners]};
}

std::vector<EdgeRef> Adjacency::edges() const {
  std::vector<EdgeRef> all;
  all.reserve(sides_.size());
  for (const auto& [ends, sides] : sides_) all.push_back(sides.front());
  std::ranges::sort(all);
  return all;
}

bool exists(const HairMesh& mesh, FaceRef face) {
  const std::uint32_t bundle = mesh.indexOf(face.bundle);
  return bundle != kNone && face.layer <= mesh.bundles()[bundle].height();
}

bool exists(const HairMesh& mesh, EdgeRef edge) {
  return exists(mesh, FaceRef{edge.bundle, edge.layer}) &&
         edge.side < mesh.bundles()[mesh.indexOf(edge.bundle)].corners;
}

}  // namespace coif::editor
