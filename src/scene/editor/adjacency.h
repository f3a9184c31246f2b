// Who touches whom on a hair mesh's layers.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "coif/hairmesh/hair_mesh.h"

namespace coif::editor {

/// Built once a query; linear in the mesh.
class Adjacency {
 public:
  explicit Adjacency(const HairMesh& mesh);

  /// The faces' sides that run along the edge of two vertices (indices), lowest bundle first.
  const std::vector<EdgeRef>& sidesOf(std::uint32_t a, std::uint32_t b) const;
  const std::vector<EdgeRef>& sidesOf(EdgeRef edge) const;
  const std::vector<std::uint32_t>& neighbours(std::uint32_t vertex) const { return neighbours_[vertex]; }
  const std::vector<FaceRef>& facesOf(std::uint32_t vertex) const { return faces_[vertex]; }
  /// The vertex indices at the ends of an edge.
  std::pair<std::uint32_t, std::uint32_t> ends(EdgeRef edge) const;
  /// Every edge once, by its canonical name, ascending.
  std::vector<EdgeRef> edges() const;
  EdgeRef canonical(EdgeRef edge) const { return sidesOf(edge).front(); }
  const HairMesh& mesh() const { return mesh_; }

 private:
  const HairMesh& mesh_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<EdgeRef>> sides_;
  std::vector<std::vector<std::uint32_t>> neighbours_;
  std::vector<std::vector<FaceRef>> faces_;
};

bool exists(const HairMesh& mesh, FaceRef face);
bool exists(const HairMesh& mesh, EdgeRef edge);

}  // namespace coif::editor
