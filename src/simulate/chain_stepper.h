// What a step does besides solving: checks, fields, sleep, lateral pulls, resets, the report. Lanes solve.
#pragma once

#include <vector>

#include "coif/simulate/solver.h"
#include "simulate/lane_block.h"

namespace coif {

/// Lateral springs as one chain feels them: entries [offsets[i], offsets[i + 1]) act on the link of node i.
struct LateralTable {
  struct Entry {
    std::uint32_t other = 0, tree = 0;  ///< tree: whose root frame turns `rest`
    double stiffness = 0;
    Vec3 rest = Vec3::Zero();  ///< signed: the other's link minus this is what this one wants
  };
  std::vector<std::uint32_t> offsets;
  std::vector<Entry> entries;
};
LateralTable lateralTable(const ChainSet& chains);

template <class T, int L>
class LaneBlocks;

class ChainStepper : public Solver {
 public:
  Result<StepReport> step(ChainState& state, std::span<ForceField* const> fields, double timeStep,
                          const RootMotion& roots, const Context& context) override;

 protected:
  ChainStepper(const ChainSet& chains, const SolverOptions& options);

  /// One sweep over all chains that are awake, neighbours apart: fills positions_, velocities_, treeFaults_
  /// and newton_.
  virtual void sweep(const Context& context) = 0;

  template <class T, int L>
  friend class LaneBlocks;

  lanes::StepConstants constants(double timeStep, bool second) const;
  bool runs(std::uint32_t tree) const {
    return asleep_[tree] == 0 && treeFaults_[tree] != lanes::LaneFault::NotFinite;
  }
  /// Of the root's joint while the step is solved: half way for the midpoint scheme.
  Mat3 frameForStep(std::uint32_t tree) const;
  /// Whether the root is moved or turned in this step, and does work.
  bool driven(std::uint32_t tree) const;
  Vec3 lateralPull(std::uint32_t node) const;
  /// Of fields and lateral springs on a node at rest where `positions` has it: what wakes a chain.
  Vec3 quietForce(std::uint32_t node, const Vec3& position) const;
  Vec3 fieldForce(std::uint32_t node, const Vec3& position, const Vec3& velocity, Mat3& stiffness) const;
  void reset(std::uint32_t tree);

  ChainSet chains_;
  SolverOptions options_;
  LateralTable laterals_;
  double meanLength_ = 1;
  std::size_t inSingle_ = 0;  // trees

  // One step's.
  const ChainState* start_ = nullptr;
  lanes::StepConstants step_, fallback_;
  std::vector<const ForceField*> fields_;
  std::vector<Vec3> positions_, velocities_;  // the result, and what neighbours see
  std::vector<Vec3> rootPositions_;
  std::vector<Mat3> rootFrames_;
  std::vector<lanes::LaneFault> treeFaults_;
  std::vector<double> newton_, lastMove_;

 private:
  Status check(const ChainState& state, double timeStep, const RootMotion& roots) const;
  void begin(ChainState& state, std::span<ForceField* const> fields, double timeStep, const RootMotion& roots,
             const Context& context);
  bool usableFrame(std::uint32_t tree);
  bool sleeps(std::uint32_t tree, double timeStep) const;
  void finish(ChainState& state, double timeStep, StepReport& report);
  void watchSleep(ChainState& state, std::uint32_t tree);
  void restQuietly(ChainState& state, std::uint32_t tree);
  void forgetHistory(ChainState& state, std::uint32_t tree) const;

  bool rootsMove_ = false;
  std::vector<Mat3> knownFrames_;  // rotations, found to be so
  std::vector<std::uint8_t> asleep_;
  std::vector<ChainFault> faults_;
};

}  // namespace coif
