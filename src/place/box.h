// The box around the internal vertices: root columns × layers, where the energy's matrix is a tensor product.
//
// Every internal vertex sits at (its root ancestor, its layer), one vertex a node, and all its side quads are
// interior; so A = P (T ⊗ L) Pᵀ exactly, for splits, mixed heights and pins alike: P picks the nodes that
// hold an internal vertex, L is the graph Laplacian of the root edges on the columns in use (Dirichlet on the
// others), T is tridiag(−1, 2, −1) over the layers in use. With M⁻¹ = P (T ⊗ L)⁻¹ Pᵀ this gives, for an error
// e = A⁻¹ r,
//
//   ‖e‖²_A = rᵀA⁻¹r ≤ rᵀM⁻¹r          (M⁻¹ ⪰ A⁻¹: Schur complement of a principal submatrix)
//   |e_v|² ≤ (A⁻¹)_vv ‖e‖²_A,  (A⁻¹)_vv ≤ (T⁻¹)_kk (L⁻¹)_rr ≤ k(N−k)/N · hops(r)
//
// (Cauchy–Schwarz; the last step is Rayleigh's monotonicity law: a resistance to the boundary is at most the
// length of a path.) So M⁻¹ is both the preconditioner and a bound on the error that holds for every solver.
//
// On a closed root component L is singular. Counterweights on the layer's external nodes make r zero-sum
// there without changing rᵀu (u = 0 on them), and then rᵀA⁻¹r ≤ r̃ᵀ(T⁻¹⊗L⁺)r̃; |e_v|² ≤ k(N−k)/N · diameter ·
// ‖e‖²_A. A layer with no external node is a free component: r sums to zero there already.
#pragma once

#include "place/preconditioner.h"
#include "place/sparse_factor.h"

namespace coif::placing {

class BoxInverse final : public Preconditioner {
 public:
  BoxInverse(const HairMesh& mesh, const PlaceSystem& system);
  void apply(const Block& r, Block& z, const Context& context) const override;

  /// Bound on max ‖e_v‖ (over unknowns, Euclidean over the columns) from Σ rᵀM⁻¹r.
  double errorBound(const Sums& rz) const;
  double errorBound(const Block& r, const Context& context) const;
  /// True when the internal vertices fill the box: then M⁻¹ = A⁻¹.
  bool exact() const { return exact_; }

 private:
  struct Column {
    std::uint32_t component = 0;
    std::uint32_t firstLayer = 0, layers = 0;  ///< its component's layers in use
  };
  struct Level {                         ///< one layer of a closed component
    std::vector<std::size_t> held, all;  ///< box cells without an internal vertex, and every cell
    const std::vector<std::size_t>& anchors() const { return held.empty() ? all : held; }
  };
  void numberColumns(const HairMesh& mesh, const PlaceSystem& system);
  void connectColumns(const HairMesh& mesh);
  void placeUnknowns(const HairMesh& mesh, const PlaceSystem& system);
  void boundReach(const std::vector<std::uint32_t>& hops);
  std::vector<std::uint32_t> hopsToBoundary() const;

  std::vector<std::uint32_t> rootOf_;    ///< layer-0 ancestor by vertex
  std::vector<std::uint32_t> columnOf_;  ///< by layer-0 vertex
  std::vector<Column> columns_;
  std::vector<std::vector<std::uint32_t>> neighbours_;  ///< columns in use beside a column
  std::vector<std::uint32_t> degree_;                   ///< root edges at a column, in use or not
  std::vector<std::uint8_t> closed_;                    ///< by component
  std::vector<std::size_t> cellOf_;                     ///< by unknown: column * maxLayers_ + slot
  std::vector<Level> levels_;
  std::size_t maxLayers_ = 0;
  double reach_ = 0;  ///< max (T⁻¹)_kk hops(r)
  bool exact_ = false;
  std::unique_ptr<SparseFactor> laplacian_;
};

}  // namespace coif::placing
