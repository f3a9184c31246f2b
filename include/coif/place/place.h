// Internal vertex placement: the quadratic energy over side quads, by conjugate gradients or directly.
//
// Minimises E = Σ over side quads ‖(c − a) − (d − b)‖² over the internal vertices (Yuksel et al. 2009,
// section 3.3, with the corrections of docs/place.md). Solves in double. Free components (no fixed vertex)
// are found by union-find; their mean is pinned to the line from root to tip.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "coif/base/context.h"
#include "coif/base/report.h"
#include "coif/base/result.h"
#include "coif/hairmesh/hair_mesh.h"

namespace coif {

enum class PlaceSolver {
  Auto,                ///< Tensor where it pays, else Direct
  ConjugateGradient,   ///< plain
  Jacobi,              ///< conjugate gradients, diagonal preconditioner
  IncompleteCholesky,  ///< conjugate gradients, incomplete factor
  Tensor,              ///< conjugate gradients, P (T⊗L)⁻¹ Pᵀ
  Direct,              ///< sparse LDLᵀ with iterative refinement: the reference
};

struct PlaceOptions {
  PlaceSolver solver = PlaceSolver::Auto;
  double tolerance = 1e-9;    ///< on the proven error, in units of the mesh's bounding-box diagonal; > 0
  int maxIterations = 20000;  ///< exceeded: a report with converged = false, never an error
};

struct PlaceReport {
  PlaceSolver solver = PlaceSolver::Auto;  ///< the one that ran
  std::size_t unknowns = 0;                ///< internal vertices
  std::size_t freeComponents = 0;
  int iterations = 0;
  bool converged = true;  ///< the solver's proven error is within the tolerance
  double condition = 0;   ///< κ of the preconditioned matrix as the iteration saw it (a lower
                          ///< bound, close when converged); 0 without an iteration
  double energyBefore = 0, energyAfter = 0;
  ErrorEstimate error;  ///< bound on the max distance to the minimiser / bounding-box diagonal
  double seconds = 0;
};

/// Moves the internal vertices of `mesh` to the minimiser, starting from where they are; external and pinned
/// ones stay bit for bit. Errors: Degenerate when a position is not finite or beyond 1e150; InvalidArgument
/// for a tolerance <= 0 or a negative maxIterations; TooLarge when Direct is asked for and its factor would
/// exceed 2e8 entries (2.4 GB); Cancelled. On an error the mesh is unchanged. Accuracy: the reported error is
/// proven (docs/place.md), not estimated; the cost of Tensor is ~ unknowns × iterations, of Direct ~
/// unknowns² on a thick mesh. Same bytes for any number of threads.
Result<PlaceReport> place(HairMesh& mesh, const PlaceOptions& options = {}, const Context& context = {});

/// place() again and again on a mesh whose topology and pins stay, as while a vertex is dragged: the matrix is
/// factored once. Same answers as place(), to the bit. Const calls may run side by side.
class Placer {
 public:
  /// Errors: those of place() but Degenerate. Cost: what place() does before its first iteration.
  static Result<Placer> create(const HairMesh& mesh, const PlaceOptions& options = {},
                               const Context& context = {});
  ~Placer();
  Placer(Placer&&) noexcept;
  Placer& operator=(Placer&&) noexcept;

  /// Whether `mesh` has the topology and pins that this was made for. Cost: linear in the mesh.
  bool fits(const HairMesh& mesh) const;
  /// As place(). Errors: also InvalidArgument for a mesh that does not fit.
  Result<PlaceReport> place(HairMesh& mesh, const Context& context = {}) const;

 private:
  struct Impl;
  explicit Placer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// E of the present positions.
double placementEnergy(const HairMesh& mesh);

/// Drag response: for a set S of external vertices moved together by Δ, every vertex moves by coefficient × Δ
/// (1 on S, 0 on other external ones). One solve here, one AXPY a mouse-move, exact (the energy is
/// quadratic). Returns one coefficient a vertex, each within options.tolerance (absolute). Errors:
/// InvalidArgument for a vertex that does not exist or is internal; TooLarge and Cancelled as place().
Result<std::vector<double>> dragResponse(const HairMesh& mesh, std::span<const std::uint32_t> selection,
                                         const PlaceOptions& options = {}, const Context& context = {});

}  // namespace coif
