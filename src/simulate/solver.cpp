#include "coif/simulate/solver.h"

#include <cmath>

#include "simulate/lane_solver.h"

namespace coif {

const char* name(DynamicsMethod method) {
  switch (method) {
    case DynamicsMethod::VanOverveld:
      return "van Overveld";
    case DynamicsMethod::ArticulatedExplicit:
      return "articulated, explicit";
    case DynamicsMethod::ArticulatedImplicit:
      return "articulated, implicit";
    case DynamicsMethod::Xpbd:
      return "XPBD";
    case DynamicsMethod::Direct:
      return "direct, Euler";
    case DynamicsMethod::DirectBdf2:
      return "direct, BDF2";
    case DynamicsMethod::EnergyKeeping:
      return "energy-keeping";
  }
  return "";
}

Result<std::unique_ptr<Solver>> makeSolver(const ChainSet& chains, const SolverOptions& options) {
  COIF_TRY(validate(chains));
  const bool fine = options.gravity.allFinite() && options.maxNewton >= 1 && options.iterations >= 1 &&
                    options.tolerance >= 0 && std::isfinite(options.tolerance) && options.sleepSpeed >= 0 &&
                    std::isfinite(options.sleepSpeed) && options.sleepSteps >= 1 &&
                    options.lateralPasses >= 1;
  if (!fine) return makeError(ErrorCode::InvalidArgument, "a solver option is outside its range");
  if (options.floatLanes)
    return std::unique_ptr<Solver>(new LaneSolver<float, lanes::kFloatLanes>(chains, options));
  return std::unique_ptr<Solver>(new LaneSolver<double, lanes::kDoubleLanes>(chains, options));
}

}  // namespace coif
