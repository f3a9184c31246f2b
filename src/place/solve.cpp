#include "place/solve.h"

#include <cmath>
#include <limits>

#include "place/cg.h"

namespace coif::placing {

namespace {

// Rounding limits what one pass of a solver reaches; a pass on the true residual adds its digits. Three do
// for any matrix whose factor exists at all; the rest is a guard.
constexpr int kMaxPasses = 8;
// A pass that gains less than this has met the rounding of the residual itself.
constexpr double kWorthwhile = 0.5;

struct Pass {
  int iterations = 0;
  bool cancelled = false;
};

// Repeats `pass` on the true residual until the bound is below target, or rounding ends the gain.
template <class RunPass>
Status refine(const PlaceSystem& system, const BoxInverse& box, const Block& strain, double target,
              int minPasses, const Context& context, Solution& solution, const RunPass& pass) {
  Block r = system.residual(strain, solution.delta);
  solution.bound = box.errorBound(r, context);
  for (int i = 0; i < kMaxPasses && (i < minPasses || solution.bound > target); ++i) {
    if (solution.bound == 0) break;
    Block candidate = solution.delta;
    const Pass done = pass(r, candidate);
    solution.iterations += done.iterations;
    if (done.cancelled || context.cancelled())
      return makeError(ErrorCode::Cancelled, "placement was cancelled");
    system.removeMeans(candidate);
    Block next = system.residual(strain, candidate);
    const double bound = box.errorBound(next, context);
    if (!(bound < solution.bound)) break;
    const bool gained = bound < kWorthwhile * solution.bound;
    solution.delta = std::move(candidate);
    solution.bound = bound;
    r = std::move(next);
    if (!gained) break;
  }
  solution.converged = solution.bound <= target;
  return {};
}

// From a few runs of `coif bench place`, not a scan: below this many operations in its factor a direct solve
// beats the iteration.
constexpr double kDirectFlops = 2e8;
constexpr double kDirectEntries = 2e6;

std::unique_ptr<Preconditioner> preconditionerFor(PlaceSolver solver, const Csr& matrix) {
  if (solver == PlaceSolver::ConjugateGradient) return makeIdentity();
  if (solver == PlaceSolver::IncompleteCholesky) return makeIncompleteCholesky(matrix);
  return makeJacobi(matrix);
}

}  // namespace

Result<Prepared> prepare(const HairMesh& mesh, const PlaceSystem& system, const PlaceOptions& options,
                         const Context& context) {
  if (context.cancelled()) return makeError(ErrorCode::Cancelled, "placement was cancelled");
  Prepared out{BoxInverse(mesh, system), std::nullopt, options.solver};
  if (out.solver == PlaceSolver::Direct) {
    out.direct = DirectSolver::make(system, kMaxFactorEntries, std::numeric_limits<double>::infinity());
    if (!out.direct) {
      return makeError(ErrorCode::TooLarge, "the direct solver's factor would exceed " +
                                                std::to_string(long(kMaxFactorEntries)) + " entries");
    }
  } else if (out.solver == PlaceSolver::Auto) {
    if (!out.box.exact()) out.direct = DirectSolver::make(system, kDirectEntries, kDirectFlops);
    out.solver = out.direct ? PlaceSolver::Direct : PlaceSolver::Tensor;
  }
  return out;
}

Result<Solution> solve(const PlaceSystem& system, const Prepared& prepared, const Block& strain,
                       double target, const PlaceOptions& options, const Context& context) {
  const BoxInverse& box = prepared.box;
  Solution solution;
  solution.solver = prepared.solver;
  solution.delta = Block::Zero(Eigen::Index(system.unknowns()), strain.cols());
  if (context.cancelled()) return makeError(ErrorCode::Cancelled, "placement was cancelled");
  if (prepared.direct) {
    COIF_TRY(refine(system, box, strain, target, options.solver == PlaceSolver::Direct ? 2 : 1, context,
                    solution, [&](const Block& r, Block& delta) {
                      prepared.direct->correct(r, delta, context);
                      return Pass{};
                    }));
    return solution;
  }

  std::unique_ptr<Preconditioner> own;
  if (solution.solver != PlaceSolver::Tensor) own = preconditionerFor(solution.solver, system.matrix());
  const Preconditioner& preconditioner = own ? *own : static_cast<const Preconditioner&>(box);
  COIF_TRY(refine(system, box, strain, target, 0, context, solution, [&](const Block& r, Block& delta) {
    Block running = r;
    const CgOutcome outcome =
        conjugateGradients(system, preconditioner, box, target, options.maxIterations - solution.iterations,
                           delta, running, context);
    if (solution.condition == 0) solution.condition = ritzCondition(outcome);
    return Pass{outcome.iterations, outcome.cancelled};
  }));
  return solution;
}

Status checkOptions(const PlaceOptions& options) {
  if (!(options.tolerance > 0) || !std::isfinite(options.tolerance)) {
    return makeError(ErrorCode::InvalidArgument, "the placement tolerance must be a number above 0");
  }
  if (options.maxIterations < 0) {
    return makeError(ErrorCode::InvalidArgument, "the greatest number of iterations must not be negative");
  }
  return {};
}

}  // namespace coif::placing
