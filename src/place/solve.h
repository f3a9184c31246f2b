// One solve: choose the solver, run it, bound the error.
#pragma once

#include <optional>

#include "coif/place/place.h"
#include "place/box.h"
#include "place/direct.h"
#include "place/system.h"

namespace coif::placing {

struct Solution {
  Block delta;  ///< of the unknowns; free components have mean 0 where iterated: pin them next
  PlaceSolver solver = PlaceSolver::Auto;
  int iterations = 0;
  bool converged = true;
  double bound = 0;      ///< proven max error over the unknowns, in the units of the field
  double condition = 0;  ///< of the preconditioned matrix, see PlaceReport
};

/// What a solve needs that depends on topology and pins alone: made once, used for every state of the mesh.
struct Prepared {
  BoxInverse box;
  std::optional<DirectSolver> direct;
  PlaceSolver solver = PlaceSolver::Auto;  ///< the one that will run
};
/// Errors: TooLarge, Cancelled.
Result<Prepared> prepare(const HairMesh& mesh, const PlaceSystem& system, const PlaceOptions& options,
                         const Context& context);

/// Minimises ‖strain + G δ‖² to an error of at most `target` > 0. Errors: Cancelled.
Result<Solution> solve(const PlaceSystem& system, const Prepared& prepared, const Block& strain,
                       double target, const PlaceOptions& options, const Context& context);

Status checkOptions(const PlaceOptions& options);

}  // namespace coif::placing
