// Steps chains through time: five families of solvers behind one interface.
//
// All but Xpbd and VanOverveld work on link directions, so that lengths are exact. The direct solvers
// minimise each step's objective ½ Σ w|x − y|² + potentials over the directions by Newton's method with
// back-tracking; the Newton system is eliminated from tip to root in O(n) (docs/simulate.md derives it).
// Chains run in lanes of 8 (double) or 16 (float), one topology a block.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "coif/base/context.h"
#include "coif/base/result.h"
#include "coif/simulate/chain.h"
#include "coif/simulate/force_field.h"

namespace coif {

enum class DynamicsMethod {
  VanOverveld,          ///< explicit step, lengths by iterated projection (van Overveld 1991)
  ArticulatedExplicit,  ///< articulated-body recursion, joint springs explicit (Featherstone)
  ArticulatedImplicit,  ///< the same with implicit joint springs (Chang et al. 2002)
  Xpbd,                 ///< extended position-based dynamics (Macklin et al. 2016)
  Direct,               ///< implicit Euler, Newton to convergence: damps, never rises
  DirectBdf2,           ///< second order, damps far less
  EnergyKeeping,        ///< second order, keeps the energy (Gonzalez 2000: midpoint, lengths at the ends)
};
const char* name(DynamicsMethod method);
inline constexpr DynamicsMethod kDynamicsMethods[] = {DynamicsMethod::VanOverveld,
                                                      DynamicsMethod::ArticulatedExplicit,
                                                      DynamicsMethod::ArticulatedImplicit,
                                                      DynamicsMethod::Xpbd,
                                                      DynamicsMethod::Direct,
                                                      DynamicsMethod::DirectBdf2,
                                                      DynamicsMethod::EnergyKeeping};

struct SolverOptions {
  DynamicsMethod method = DynamicsMethod::Direct;
  Vec3 gravity = Vec3(0, -9.81, 0);  ///< built in, cheaper than a field
  int maxNewton = 20;                ///< direct methods
  int iterations = 20;               ///< VanOverveld, Xpbd: sweeps a step
  /// Newton stops once no node moves further than this fraction of the mean link. Say what a tenth of a pixel
  /// is to stop earlier; 0: to rounding.
  double tolerance = 1e-7;
  /// 16 chains at once in single precision; those of more than 100 links or with masses more than 1e4 apart
  /// stay in double.
  bool floatLanes = false;
  /// Chains at rest are skipped until their root, a field's force or a neighbour's pull changes: a chain
  /// sleeps after sleepSteps steps in which no node moved faster than sleepSpeed. 0: never.
  double sleepSpeed = 0;
  int sleepSteps = 10;
  bool skipBending = true;  ///< leave the bending terms out of blocks whose joints have no stiffness
  int lateralPasses = 1;    ///< sweeps over coloured chains a step, where there are lateral springs
};

/// Everything a step changes; copy it to save, resume and compare. Arrays of N but where said.
struct ChainState {
  std::vector<Vec3> positions, velocities;
  std::vector<Vec3> previousPositions, previousVelocities;  ///< one step back, for DirectBdf2
  std::vector<Mat3> rootFrames;                             ///< T
  std::vector<std::uint32_t> quietSteps;                    ///< T: steps at rest
  std::vector<Vec3> quietForces;                            ///< of the fields when a chain fell asleep
  double time = 0;
  double previousStep = 0;  ///< 0: nothing before
};
ChainState restState(const ChainSet& chains);

/// Where the scalp is at the end of the step; empty: where it was. T entries. Frames are rotations.
struct RootMotion {
  std::span<const Vec3> positions;
  std::span<const Mat3> frames;
};

enum class ChainFaultKind {
  NotFinite,     ///< a force, root or state that is not finite; reset: rigidly with its root, at rest
  NotConverged,  ///< maxNewton reached; the best iterate is kept (EnergyKeeping: an implicit Euler step)
};
struct ChainFault {
  std::uint32_t tree = 0;
  ChainFaultKind kind = ChainFaultKind::NotFinite;
  double left = 0;  ///< NotConverged: how far the last Newton step moved a node, in mean links
};

struct StepReport {
  std::size_t solved = 0, asleep = 0;  ///< trees
  std::size_t inSingle = 0;            ///< trees that are solved in single precision when they are awake
  int maxNewton = 0;                   ///< of any tree
  double meanNewton = 0;
  double seconds = 0;
  std::span<const ChainFault> faults;  ///< ascending by tree; lives until the next step
};

class Solver {
 public:
  virtual ~Solver() = default;
  /// Advances the state by `timeStep` > 0. Fields that are not active() cost nothing. A chain that fails is
  /// reset and reported; it never touches another. Allocates nothing after the first step. Same bytes for any
  /// number of threads. Errors: InvalidArgument for a time step that is not positive or arrays of the wrong
  /// size; the state is unchanged.
  virtual Result<StepReport> step(ChainState& state, std::span<ForceField* const> fields, double timeStep,
                                  const RootMotion& roots = {}, const Context& context = {}) = 0;
};

/// Keeps its own copy of what it needs of `chains`. Errors: those of validate(chains), InvalidArgument for
/// options out of range.
Result<std::unique_ptr<Solver>> makeSolver(const ChainSet& chains, const SolverOptions& options = {});

/// Kinetic, gravitational (zero at the origin) and joint energy, lateral springs included.
struct ChainEnergy {
  double kinetic = 0, gravity = 0, bending = 0, lateral = 0;
  double total() const { return kinetic + gravity + bending + lateral; }
};
ChainEnergy chainEnergy(const ChainSet& chains, const ChainState& state, const Vec3& gravity);
/// max over links | |d| / ℓ − 1 |.
double maxStretch(const ChainSet& chains, std::span<const Vec3> positions);

}  // namespace coif
