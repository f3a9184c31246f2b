#include "simulate/lane_blocks.h"

#include <algorithm>
#include <cmath>
#include <thread>

#include "coif/base/parallel.h"

namespace coif {

namespace {
// A chunk holds about this many links: well over what handing it to a thread costs.
constexpr std::size_t kLinksAChunk = 1024;
}  // namespace

template <class T, int L>
LaneBlocks<T, L>::LaneBlocks(ChainStepper& stepper, const std::vector<std::uint8_t>& single)
    : stepper_(stepper), bins_(binChains(stepper.chains_, stepper.options_.skipBending)) {
  for (ChainBin& bin : bins_)
    std::erase_if(bin.trees, [&](std::uint32_t t) { return (single[t] != 0) != (sizeof(T) == 4); });
  makeBlocks();
}

template <class T, int L>
void LaneBlocks<T, L>::makeBlocks() {
  const ChainSet& chains = stepper_.chains_;
  std::size_t links = 0;
  for (std::uint32_t b = 0; b < bins_.size(); ++b) {
    const ChainBin& bin = bins_[b];
    for (std::size_t from = 0; from < bin.trees.size(); from += L) {
      LaneBlock block;
      block.bin = b;
      block.used = int(std::min<std::size_t>(L, bin.trees.size() - from));
      block.constants.resize(bin.parents.size());
      for (int l = 0; l < L; ++l) {
        block.trees[l] = bin.trees[from + std::size_t(l < block.used ? l : 0)];
        const std::uint32_t root = block.roots[l] = chains.treeOffsets[block.trees[l]];
        for (std::size_t n = 0; n < bin.parents.size(); ++n) {
          lanes::NodeConstants<T, L>& c = block.constants[n];
          const std::size_t i = root + n;
          c.length[l] = n > 0 ? T(chains.lengths[i]) : T(1);
          c.perLength[l] = T(1) / c.length[l];
          c.mass[l] = T(chains.masses[i]);
          c.kappa[l] = n > 0 ? T(chains.stiffness[i]) : T(0);
          if (n > 0 && bin.parents[n] == 0 && bin.anyFree) c.kappa[l] = 0;
          c.drag[l] = T(chains.drags[i]);
          for (int k = 0; k < 3; ++k) c.rest[k][l] = T(chains.restDirections[i][k]);
        }
      }
      blocks_.push_back(std::move(block));
    }
    if (!bin.trees.empty()) {
      links += bin.trees.size() * (bin.parents.size() - 1);
      largest_ = std::max(largest_, bin.parents.size());
      largestStash_ = std::max(largestStash_, std::size_t(bin.slotCount));
    }
    if (b + 1 == bins_.size() || bins_[b + 1].colour != bin.colour) colourEnds_.push_back(blocks_.size());
  }
  const std::size_t each = std::max<std::size_t>(1, links / std::max<std::size_t>(1, blocks_.size()));
  grain_ = std::max<std::size_t>(1, kLinksAChunk / each);
}

template <class T, int L>
void LaneBlocks<T, L>::makeScratch(const Context& context) {
  const std::size_t threads =
      context.threads > 0 ? std::size_t(context.threads) : std::max(1u, std::thread::hardware_concurrency());
  while (scratches_.size() < threads + 1) {  // the caller's thread may join an arena of `threads`
    auto scratch = std::make_unique<Scratch>();
    scratch->work.resize(largest_);
    scratch->stashes.resize(largestStash_);
    scratches_.push_back(std::move(scratch));
  }
}

template <class T, int L>
auto LaneBlocks<T, L>::takeScratch() -> Scratch& {
  for (;;) {
    for (const std::unique_ptr<Scratch>& scratch : scratches_) {
      if (!scratch->busy.test_and_set(std::memory_order_acquire)) return *scratch;
    }
    std::this_thread::yield();
  }
}

template <class T, int L>
lanes::Kernel<T, L> LaneBlocks<T, L>::kernel() const {
  const lanes::Kernels& best = lanes::bestKernels();
  const auto choose = [this](auto direct, auto overveld, auto xpbd) {
    if (stepper_.options_.method == DynamicsMethod::VanOverveld) return overveld;
    return stepper_.options_.method == DynamicsMethod::Xpbd ? xpbd : direct;
  };
  if constexpr (sizeof(T) == 8) {
    return choose(best.direct, best.overveld, best.xpbd);
  } else {
    return choose(best.directFloat, best.overveldFloat, best.xpbdFloat);
  }
}

template <class T, int L>
void LaneBlocks<T, L>::solve(std::size_t colour, const Context& context) {
  const std::size_t first = colour > 0 ? colourEnds_[colour - 1] : 0, last = colourEnds_[colour];
  if (first == last) return;
  makeScratch(context);
  Context all = context;
  all.cancel = nullptr;  // half a step would be none
  struct Args {
    LaneBlocks* self;
    std::size_t first;
  } args{this, first};
  parallelFor(all, last - first, grain_, [&args](std::size_t begin, std::size_t end) {
    Scratch& scratch = args.self->takeScratch();
    for (std::size_t b = begin; b < end; ++b)
      args.self->solveBlock(args.self->blocks_[args.first + b], scratch);
    scratch.busy.clear(std::memory_order_release);
  });
}

template <class T, int L>
void LaneBlocks<T, L>::solveBlock(const LaneBlock& block, Scratch& scratch) {
  bool run[L], again[L];
  bool any = false, repeat = false;
  for (int l = 0; l < L; ++l) {
    run[l] = l < block.used && stepper_.runs(block.trees[l]);
    any |= run[l];
  }
  if (!any) return;
  lanes::Block<T, L> lane;
  FieldCall call{this, &block, scratch.work.data()};
  lane.context = &call;
  if (!stepper_.fields_.empty()) lane.fields = &LaneBlocks::callFields;
  gather(block, scratch, lane);
  for (int l = 0; l < L; ++l) lane.active[l] = T(run[l]);
  kernel()(lane, stepper_.step_);
  for (int l = 0; l < L; ++l) {
    again[l] = run[l] && stepper_.step_.scheme == lanes::Scheme::Midpoint &&
               lane.fault[l] == lanes::LaneFault::NotConverged;
    repeat |= again[l];
    run[l] = run[l] && !again[l];
  }
  scatter(block, lane, run);
  if (!repeat) return;
  gather(block, scratch, lane);  // the midpoint's equations had no solution that Newton found
  for (int l = 0; l < L; ++l) lane.active[l] = T(again[l]);
  kernel()(lane, stepper_.fallback_);
  for (int l = 0; l < L; ++l) {
    if (again[l] && lane.fault[l] == lanes::LaneFault::None) lane.fault[l] = lanes::LaneFault::NotConverged;
  }
  scatter(block, lane, again);
}

template <class T, int L>
void LaneBlocks<T, L>::gather(const LaneBlock& block, Scratch& scratch, lanes::Block<T, L>& out) {
  const ChainBin& bin = bins_[block.bin];
  out.nodes = std::int32_t(bin.parents.size());
  out.parents = bin.parents.data();
  out.slots = bin.slots.data();
  out.constants = block.constants.data();
  out.work = scratch.work.data();
  out.stashes = scratch.stashes.data();
  out.bend = bin.bend, out.curved = bin.curved, out.anyFree = bin.anyFree;
  out.lateral = !stepper_.laterals_.entries.empty();
  for (int l = 0; l < L; ++l) {
    const std::uint32_t tree = block.trees[l];
    const Mat3 frame = stepper_.frameForStep(tree);
    for (int k = 0; k < 9; ++k) out.rootAxes[k][l] = T(frame(k % 3, k / 3));
    out.freeRoot[l] = stepper_.chains_.freeRoots[tree];
    out.driven[l] = T(stepper_.driven(tree));
  }
  for (int n = 0; n < out.nodes; ++n) gatherNode(block, n, scratch.work[std::size_t(n)]);
  for (int l = 0; l < L; ++l) {
    const Vec3 moved = stepper_.rootPositions_[block.trees[l]] - stepper_.start_->positions[block.roots[l]];
    for (int k = 0; k < 3; ++k) scratch.work[0].x[k][l] = T(moved[k]);
  }
}

template <class T, int L>
void LaneBlocks<T, L>::gatherNode(const LaneBlock& block, int node, lanes::NodeWork<T, L>& work) const {
  const bool history = stepper_.step_.scheme == lanes::Scheme::Bdf2;
  for (int l = 0; l < L; ++l) {
    const std::size_t i = block.roots[l] + std::size_t(node);
    const Vec3& place = stepper_.start_->positions[i];
    const Vec3 offset = place - stepper_.start_->positions[block.roots[l]];
    for (int k = 0; k < 3; ++k) {
      work.start[k][l] = offset[k];
      work.v0[k][l] = T(stepper_.start_->velocities[i][k]);
      if (!history) continue;
      work.back[k][l] = T(stepper_.start_->previousPositions[i][k] - place[k]);
      work.vBack[k][l] = T(stepper_.start_->previousVelocities[i][k]);
    }
  }
  if (stepper_.laterals_.entries.empty() || node == 0) return;
  for (int l = 0; l < L; ++l) {
    const Vec3 pull = stepper_.lateralPull(block.roots[l] + std::uint32_t(node));
    for (int k = 0; k < 3; ++k) work.lateral[k][l] = T(pull[k]);
  }
}

template <class T, int L>
void LaneBlocks<T, L>::callFields(void* context) {
  const FieldCall& call = *static_cast<const FieldCall*>(context);
  const ChainStepper& stepper = call.blocks->stepper_;
  const std::size_t nodes = call.blocks->bins_[call.block->bin].parents.size();
  Mat3 stiffness;
  for (std::size_t n = 0; n < nodes; ++n) {
    lanes::NodeWork<T, L>& w = call.work[n];
    for (int l = 0; l < L; ++l) {
      const bool used = l < call.block->used;
      const auto i = std::uint32_t(call.block->roots[l] + n);
      Vec3 force = Vec3::Zero();
      stiffness.setZero();
      if (used) {
        const Vec3 at = stepper.start_->positions[i] + Vec3(w.move[0][l], w.move[1][l], w.move[2][l]);
        force = stepper.fieldForce(i, at, Vec3(w.v[0][l], w.v[1][l], w.v[2][l]), stiffness);
      }
      for (int k = 0; k < 3; ++k) w.force[k][l] = T(force[k]);
      const double upper[6] = {stiffness(0, 0), stiffness(0, 1), stiffness(0, 2),
                               stiffness(1, 1), stiffness(1, 2), stiffness(2, 2)};
      for (int k = 0; k < 6; ++k) w.stiffness[k][l] = T(upper[k]);
    }
  }
}

template <class T, int L>
void LaneBlocks<T, L>::scatter(const LaneBlock& block, const lanes::Block<T, L>& in, const bool* which) {
  const std::size_t nodes = bins_[block.bin].parents.size();
  for (int l = 0; l < L; ++l) {
    if (!which[l]) continue;
    const std::uint32_t tree = block.trees[l];
    stepper_.treeFaults_[tree] = in.fault[l];
    stepper_.newton_[tree] = std::max(stepper_.newton_[tree], double(in.newtonSteps[l]));
    stepper_.lastMove_[tree] = double(in.lastMove[l]);
    const std::uint32_t root = block.roots[l];
    // A prescribed root is where it has to be to the bit, and the chain with it: T may not hold how far it
    // went.
    const lanes::NodeWork<T, L>& first = in.work[0];
    const bool isFree = stepper_.chains_.freeRoots[tree] != 0;
    const Vec3 origin =
        isFree
            ? stepper_.start_->positions[root]
            : Vec3(stepper_.rootPositions_[tree] - Vec3(first.end[0][l], first.end[1][l], first.end[2][l]));
    bool finite = true;
    for (std::uint32_t n = 0; n < nodes; ++n) {
      const lanes::NodeWork<T, L>& w = in.work[n];
      stepper_.positions_[root + n] = origin + Vec3(w.end[0][l], w.end[1][l], w.end[2][l]);
      stepper_.velocities_[root + n] = Vec3(w.v[0][l], w.v[1][l], w.v[2][l]);
      finite &= stepper_.positions_[root + n].allFinite() && stepper_.velocities_[root + n].allFinite();
    }
    if (!isFree) stepper_.positions_[root] = stepper_.rootPositions_[tree];
    if (!finite) stepper_.treeFaults_[tree] = lanes::LaneFault::NotFinite;
    // Neighbours must not see it before the step's end resets it.
    if (stepper_.treeFaults_[tree] == lanes::LaneFault::NotFinite) stepper_.reset(tree);
  }
}

template class LaneBlocks<double, lanes::kDoubleLanes>;
template class LaneBlocks<float, lanes::kFloatLanes>;

}  // namespace coif
