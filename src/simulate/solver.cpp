#include "coif/simulate/solver.h"

#include <algorithm>
#include <cmath>

#include "simulate/lane_blocks.h"

namespace coif {

namespace {

// Single precision holds no more: the torture grid's bars (docs/simulate.md).
constexpr std::uint32_t kMostFloatLinks = 100;
constexpr double kMostFloatMassRatio = 1e4;

bool fitsFloat(const ChainSet& c, std::size_t tree) {
  const std::uint32_t root = c.treeOffsets[tree], end = c.treeOffsets[tree + 1];
  if (end - root - 1 > kMostFloatLinks || end - root < 2) return false;
  const auto [least, most] =
      std::minmax_element(c.masses.begin() + root + (c.freeRoots[tree] ? 0 : 1), c.masses.begin() + end);
  return *most <= kMostFloatMassRatio * *least;
}

std::vector<std::uint8_t> singleTrees(const ChainSet& chains, bool floatLanes) {
  std::vector<std::uint8_t> single(chains.treeCount(), 0);
  for (std::size_t t = 0; t < single.size() && floatLanes; ++t) single[t] = fitsFloat(chains, t);
  return single;
}

class LaneSolver final : public ChainStepper {
 public:
  LaneSolver(const ChainSet& chains, const SolverOptions& options)
      : LaneSolver(chains, options, singleTrees(chains, options.floatLanes)) {}

 private:
  LaneSolver(const ChainSet& chains, const SolverOptions& options, const std::vector<std::uint8_t>& single)
      : ChainStepper(chains, options), doubles_(*this, single), floats_(*this, single) {
    inSingle_ = std::size_t(std::ranges::count(single, 1));
  }

  void sweep(const Context& context) override {
    for (std::size_t colour = 0; colour < doubles_.colours(); ++colour) {
      doubles_.solve(colour, context);
      floats_.solve(colour, context);
    }
  }

  LaneBlocks<double, lanes::kDoubleLanes> doubles_;
  LaneBlocks<float, lanes::kFloatLanes> floats_;
};

}  // namespace

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
  return std::unique_ptr<Solver>(new LaneSolver(chains, options));
}

}  // namespace coif
