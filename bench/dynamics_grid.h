// The torture grid: every combination of time step, joint stiffness, mass ratio, length and defect.
#pragma once

#include <vector>

#include "bench/dynamics_problem.h"

namespace coif {

enum class GridDefect { None, CoincidentNodes, FoldedBack, SpunRoot, NaNForce };

struct GridCase {
  double kappa = 0, ratio = 1;  ///< joint stiffness; the tip's mass over another node's
  GridDefect defect = GridDefect::None;
};

/// One chain a case, a metre long and level at the start, side by side.
struct DynamicsGrid {
  std::vector<GridCase> cases;
  ChainSet chains;
  ChainState state;
};
DynamicsGrid dynamicsGrid(std::size_t links);

/// NaN on the chains whose defect it is, while `bad`.
class GridForce : public ForceField {
 public:
  GridForce(const DynamicsGrid& grid, bool bad);
  void prepare(const NodeView&, double, double, const Context&) override {}
  void add(std::uint32_t node, const Vec3&, const Vec3&, Vec3& force, Mat3&) const override;
  double energy(std::uint32_t, const Vec3&) const override { return 0; }

 private:
  std::vector<std::uint8_t> flags_;
  bool bad_;
};

struct GridTally {
  int chains = 0;
  int notFinite = 0;     ///< chains that end with a number that is none
  int stretched = 0;     ///< beyond 1e-9 of the link (float lanes: 1e-5)
  int risen = 0;         ///< whose energy rose by more than 1e-5 of its scale without work
  int wronglyReset = 0;  ///< steps that reset a chain without a defect that calls for it
  int notConverged = 0;  ///< chain-steps that stopped at the limit of Newton steps
  int chainSteps = 0;
  int mostNewton = 0;
  double stretch = 0;  ///< the greatest
  double meanNewton = 0;
  std::vector<double> left;  ///< of those that stopped: how far the last step moved a node, of a link
  GridTally& operator+=(const GridTally& other);
};

/// `steps` steps of every case with one method. Spun roots turn by two radians a step and are thrown about.
GridTally runGrid(DynamicsMethod method, std::size_t links, double timeStep, int steps,
                  bool floatLanes = false, int maxNewton = 20);

}  // namespace coif
