// Chains of one precision in lanes: gathers them, runs a kernel on each block, scatters what came out.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <vector>

#include "simulate/binning.h"
#include "simulate/chain_stepper.h"

namespace coif {

/// A part of a stepper's chains: reads its step and writes its results, chain by chain.
template <class T, int L>
class LaneBlocks {
 public:
  /// `single`: by tree, whether it is solved in single precision; the others are left out (float) or these
  /// (double).
  LaneBlocks(ChainStepper& stepper, const std::vector<std::uint8_t>& single);

  std::size_t colours() const { return colourEnds_.size(); }
  /// Chains of one colour, which see none of each other.
  void solve(std::size_t colour, const Context& context);

 private:
  struct LaneBlock {
    std::uint32_t bin = 0;
    std::array<std::uint32_t, L> trees{};  ///< unused lanes repeat the first
    std::array<std::uint32_t, L> roots{};  ///< their first nodes
    int used = 0;
    std::vector<lanes::NodeConstants<T, L>> constants;
  };
  struct Scratch {
    std::vector<lanes::NodeWork<T, L>> work;
    std::vector<lanes::Stash<T, L>> stashes;
    std::atomic_flag busy;
  };
  struct FieldCall {
    const LaneBlocks* blocks = nullptr;
    const LaneBlock* block = nullptr;
    lanes::NodeWork<T, L>* work = nullptr;
  };

  void makeBlocks();
  void makeScratch(const Context& context);
  Scratch& takeScratch();
  lanes::Kernel<T, L> kernel() const;
  void solveBlock(const LaneBlock& block, Scratch& scratch);
  void gather(const LaneBlock& block, Scratch& scratch, lanes::Block<T, L>& out);
  void gatherNode(const LaneBlock& block, int node, lanes::NodeWork<T, L>& work) const;
  void scatter(const LaneBlock& block, const lanes::Block<T, L>& in, const bool* which);
  static void callFields(void* context);

  ChainStepper& stepper_;
  std::vector<ChainBin> bins_;
  std::vector<LaneBlock> blocks_;
  std::vector<std::size_t> colourEnds_;  ///< by colour, into blocks_
  std::size_t grain_ = 1, largest_ = 0, largestStash_ = 0;
  std::vector<std::unique_ptr<Scratch>> scratches_;
};

}  // namespace coif
