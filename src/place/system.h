// The linear system of placement: unknowns, matrix, residual, and what the energy leaves free.
//
// With G one row a side quad (−1 on a, +1 on b, +1 on c, −1 on d), E = ‖G x‖² and A = (GᵀG) on the internal
// vertices. A's entries are small integers: no rounding, no geometry.
//
// Null space. Let u vanish on the external vertices with G u = 0, so u_c − u_d = u_a − u_b on every quad.
// Layer 0 is external: u = 0 there. Every edge of layer k + 1 is the upper edge of a quad whose lower edge is
// in layer k, so by induction u is constant along every lateral edge of every layer. Hence u is constant on
// each connected lateral component of each layer, and 0 on those with an external vertex; conversely every
// such u has G u = 0. The null space is spanned exactly by the indicators of the (layer, component) pairs
// without an external vertex.
#pragma once

#include <array>

#include "coif/base/vec.h"
#include "coif/hairmesh/hair_mesh.h"
#include "place/block.h"

namespace coif::placing {

class PlaceSystem {
 public:
  explicit PlaceSystem(const HairMesh& mesh);

  std::size_t unknowns() const { return vertexOf_.size(); }
  std::size_t freeCount() const { return freeCount_; }
  const Csr& matrix() const { return matrix_; }
  bool external(std::uint32_t vertex) const { return unknownOf_[vertex] == kNone; }
  std::uint32_t vertexOf(std::size_t unknown) const { return vertexOf_[unknown]; }
  std::uint32_t unknownOf(std::uint32_t vertex) const { return unknownOf_[vertex]; }
  /// The free component an unknown belongs to, or kNone.
  std::uint32_t freeOf(std::size_t unknown) const { return freeOf_[unknown]; }

  /// G x of a field over all vertices, for the quads that touch an unknown.
  Block strain(const Block& field) const;
  /// −Gᵀ(strain + G δ) on the unknowns: half the downhill gradient after moving the unknowns by δ. Working on
  /// differences keeps the rounding relative to the mesh's own size, wherever it lies.
  Block residual(const Block& strain, const Block& delta) const;
  /// Takes from every free component its mean.
  void removeMeans(Block& delta) const;
  /// Shifts every free component so that its mean lies on the line from its root to its tip: the mean over
  /// its vertices of (1 − k/n) root + (k/n) tip, averaged over the bundle columns through a vertex.
  void pinMeans(const HairMesh& mesh, const Block& field, Block& delta) const;

 private:
  using Corners = std::array<std::uint32_t, 4>;
  void findFreeComponents(const HairMesh& mesh, const std::vector<SideQuad>& quads);
  void assemble();

  std::vector<std::uint32_t> vertexOf_, unknownOf_, freeOf_;
  std::vector<Corners> quads_;  ///< vertex indices of the quads that touch an unknown
  std::size_t freeCount_ = 0;
  Csr matrix_;
};

}  // namespace coif::placing
