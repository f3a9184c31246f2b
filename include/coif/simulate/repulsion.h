// Hair keeps its volume: nodes are pushed out of where hair is denser than it may be.
#pragma once

#include <vector>

#include "coif/simulate/force_field.h"
#include "coif/strands/point_splat.h"

namespace coif {

struct RepulsionOptions {
  double stiffness = 0;    ///< k of E = ½ k ∫ max(ρ − restDensity, 0)², >= 0; 0: off
  double restDensity = 0;  ///< mass a volume that is not pushed, >= 0
  double cell = 1;         ///< of the grid, > 0
  int maxLog2Size = 6;     ///< the cell doubles rather than the grid pass 2^this cells a side
  double friction = 0;     ///< rate at which a node takes on the mean velocity of the hair around it
};

/// E = ½ k V Σ_cells max(ρ − ρ0, 0)² with ρ the quadratic-spline density of node masses and V a cell's volume
/// (Bertails et al. 2005). At the step's start the force is the exact −∂E/∂x of all nodes together. Within
/// the step it is continued linearly, f = f₀ − K (x − x̂), with x̂ where the hair around the node carries it
/// (start + h · mean velocity), so that hair moving as one is not held back, and K a block-diagonal majorant
/// of the Gauss–Newton Hessian: chains that are solved one by one do not overshoot together. Cost: O(nodes)
/// and O(cells) a step; add() looks nothing up.
class RepulsionField final : public ForceField {
 public:
  explicit RepulsionField(const RepulsionOptions& options) : options_(options) {}

  void prepare(const NodeView& start, double time, double timeStep, const Context& context) override;
  void add(std::uint32_t node, const Vec3& position, const Vec3& velocity, Vec3& force,
           Mat3& stiffness) const override;
  double energy(std::uint32_t node, const Vec3& position) const override;
  bool active() const override { return active_; }
  const char* idleReason() const override;

  /// Density of hair at the step's start; channel 0 of four (the others: momentum density).
  const GridFrame& frame() const { return frame_; }
  double densityAt(const Vec3& position) const;
  double maxDensity() const { return maxDensity_; }
  double totalEnergy() const { return energy_; }  ///< at the step's start

 private:
  struct Local {
    Vec3 force = Vec3::Zero(), start = Vec3::Zero(), carried = Vec3::Zero(), meanVelocity = Vec3::Zero();
    Mat3 stiffness = Mat3::Zero();
    double friction = 0;
  };
  void linearise(const NodeView& start, std::size_t node, double timeStep);

  RepulsionOptions options_;
  GridFrame frame_;
  PointSplatter splatter_;
  std::vector<double> values_, masses_;
  std::vector<Vec3> points_;
  std::vector<float> grid_, slopes_;
  std::vector<Local> locals_;
  double inverseStep_ = 0, maxDensity_ = 0, energy_ = 0;
  bool active_ = false;
};

}  // namespace coif
