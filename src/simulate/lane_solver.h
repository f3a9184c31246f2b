// Gathers chains into lanes, runs a kernel on each block, scatters what came out.
#pragma once

#include <atomic>
#include <memory>
#include <vector>

#include "coif/simulate/solver.h"
#include "simulate/binning.h"
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
class LaneSolver : public Solver {
 public:
  LaneSolver(const ChainSet& chains, const SolverOptions& options);
  Result<StepReport> step(ChainState& state, std::span<ForceField* const> fields, double timeStep,
                          const RootMotion& roots, const Context& context) override;

 private:
  struct LaneBlock {
    std::uint32_t bin = 0;
    std::array<std::uint32_t, L> trees{};  ///< unused lanes repeat the first
    int used = 0;
    std::vector<lanes::NodeConstants<T, L>> constants;
  };
  struct Scratch {
    std::vector<lanes::NodeWork<T, L>> work;
    std::vector<lanes::Stash<T, L>> stashes;
    std::atomic_flag busy;
  };
  struct FieldCall {
    LaneSolver* solver = nullptr;
    const LaneBlock* block = nullptr;
    lanes::NodeWork<T, L>* work = nullptr;
  };

  Status check(const ChainState& state, double timeStep, const RootMotion& roots) const;
  void makeBlocks();
  void makeScratch(const Context& context);
  Scratch& takeScratch();
  lanes::Kernel<T, L> kernel() const;
  lanes::StepConstants constants(double timeStep, bool second) const;
  void begin(ChainState& state, std::span<ForceField* const> fields, double timeStep, const RootMotion& roots,
             const Context& context);
  bool sleeps(std::uint32_t tree, double timeStep) const;
  void solveColour(std::size_t first, std::size_t last, const Context& context);
  void solveBlock(const LaneBlock& block, Scratch& scratch);
  void gather(const LaneBlock& block, Scratch& scratch, lanes::Block<T, L>& out);
  void gatherNode(const LaneBlock& block, int node, lanes::NodeWork<T, L>& work) const;
  void scatter(const LaneBlock& block, const lanes::Block<T, L>& in, const bool* which);
  void reset(std::uint32_t tree);
  void finish(ChainState& state, double timeStep, StepReport& report);
  void forgetHistory(ChainState& state, std::uint32_t tree) const;
  void restQuietly(ChainState& state, std::uint32_t tree);
  Vec3 lateralPull(std::uint32_t node) const;
  Mat3 frameForStep(std::uint32_t tree) const;
  Vec3 fieldForce(std::uint32_t node, const Vec3& position, const Vec3& velocity, Mat3& stiffness) const;
  static void callFields(void* context);

  ChainSet chains_;
  SolverOptions options_;
  std::vector<ChainBin> bins_;
  std::vector<LaneBlock> blocks_;
  std::vector<std::size_t> colourEnds_;
  LateralTable laterals_;
  double meanLength_ = 1;
  std::size_t grain_ = 1, largest_ = 0, largestStash_ = 0;
  std::vector<std::unique_ptr<Scratch>> scratches_;

  // One step's.
  const ChainState* start_ = nullptr;
  lanes::StepConstants step_, fallback_;
  std::vector<const ForceField*> fields_;
  std::vector<Vec3> positions_, velocities_;  // the result, and what neighbours see
  std::vector<Vec3> rootPositions_;
  std::vector<Mat3> rootFrames_;
  std::vector<lanes::LaneFault> treeFaults_;
  std::vector<double> newton_;
  std::vector<std::uint8_t> asleep_;
  std::vector<ChainFault> faults_;
};

}  // namespace coif
