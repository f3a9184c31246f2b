// Preconditioned conjugate gradients on several right-hand sides, stopped on a bound of the error.
#pragma once

#include "place/box.h"

namespace coif::placing {

struct CgOutcome {
  int iterations = 0;
  bool cancelled = false;
  std::vector<double> alpha, beta;  ///< of the column that had most to do: its Lanczos coefficients
};

/// Improves `delta` in A δ = rhs, given r = rhs − A δ; r is updated along (so it drifts from the true
/// residual by rounding). Stops when box.errorBound <= target, after maxIterations, or when a column breaks
/// down. `m` may be `box` itself: then the bound costs nothing; else it costs one box.apply, every tenth
/// iteration at most.
CgOutcome conjugateGradients(const PlaceSystem& system, const Preconditioner& m, const BoxInverse& box,
                             double target, int maxIterations, Block& delta, Block& r,
                             const Context& context);

/// κ of the preconditioned matrix as far as the iteration saw it: the quotient of the extreme eigenvalues of
/// its Lanczos matrix, which lie inside the spectrum, so a lower bound. 0 without an iteration.
double ritzCondition(const CgOutcome& outcome);

}  // namespace coif::placing
