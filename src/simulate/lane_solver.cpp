#include "simulate/lane_solver.h"

#include <algorithm>
#include <cmath>
#include <thread>

#include "coif/base/parallel.h"
#include "coif/base/report.h"

namespace coif {

namespace {

// A chunk holds about this many links: well over what handing it to a thread costs.
constexpr std::size_t kLinksAChunk = 1024;

bool isFrame(const Mat3& m) {
  return m.allFinite() && (m.transpose() * m - Mat3::Identity()).norm() < 1e-3;
}

}  // namespace

template <class T, int L>
LaneSolver<T, L>::LaneSolver(const ChainSet& chains, const SolverOptions& options)
    : chains_(chains), options_(options), bins_(binChains(chains, options.skipBending)) {
  laterals_ = lateralTable(chains);
  makeBlocks();
  double sum = 0;
  for (std::size_t i = 0; i < chains.nodeCount(); ++i)
    sum += chains.parents[i] == kNone ? 0 : chains.lengths[i];
  meanLength_ = chains.linkCount() > 0 ? sum / double(chains.linkCount()) : 1;
  positions_.resize(chains.nodeCount());
  velocities_.resize(chains.nodeCount());
  rootPositions_.resize(chains.treeCount());
  rootFrames_.resize(chains.treeCount());
  treeFaults_.resize(chains.treeCount());
  newton_.resize(chains.treeCount());
  asleep_.resize(chains.treeCount());
  faults_.reserve(chains.treeCount());
}

template <class T, int L>
void LaneSolver<T, L>::makeBlocks() {
  for (std::uint32_t b = 0; b < bins_.size(); ++b) {
    const ChainBin& bin = bins_[b];
    for (std::size_t from = 0; from < bin.trees.size(); from += L) {
      LaneBlock block;
      block.bin = b;
      block.used = int(std::min<std::size_t>(L, bin.trees.size() - from));
      block.constants.resize(bin.parents.size());
      for (int l = 0; l < L; ++l) {
        block.trees[l] = bin.trees[from + std::size_t(l < block.used ? l : 0)];
        const std::uint32_t root = chains_.treeOffsets[block.trees[l]];
        for (std::size_t n = 0; n < bin.parents.size(); ++n) {
          lanes::NodeConstants<T, L>& c = block.constants[n];
          const std::size_t i = root + n;
          c.length[l] = n > 0 ? T(chains_.lengths[i]) : T(1);
          c.mass[l] = T(chains_.masses[i]);
          c.kappa[l] = n > 0 ? T(chains_.stiffness[i]) : T(0);
          if (n > 0 && bin.parents[n] == 0 && bin.anyFree) c.kappa[l] = 0;
          c.drag[l] = T(chains_.drags[i]);
          for (int k = 0; k < 3; ++k) c.rest[k][l] = T(chains_.restDirections[i][k]);
        }
      }
      blocks_.push_back(std::move(block));
    }
    largest_ = std::max(largest_, bin.parents.size());
    largestStash_ = std::max(largestStash_, std::size_t(bin.slotCount));
    if (b + 1 == bins_.size() || bins_[b + 1].colour != bin.colour) colourEnds_.push_back(blocks_.size());
  }
  const std::size_t links =
      std::max<std::size_t>(1, chains_.linkCount() / std::max<std::size_t>(1, blocks_.size()));
  grain_ = std::max<std::size_t>(1, kLinksAChunk / links);
}

template <class T, int L>
void LaneSolver<T, L>::makeScratch(const Context& context) {
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
auto LaneSolver<T, L>::takeScratch() -> Scratch& {
  for (;;) {
    for (const std::unique_ptr<Scratch>& scratch : scratches_) {
      if (!scratch->busy.test_and_set(std::memory_order_acquire)) return *scratch;
    }
    std::this_thread::yield();
  }
}

template <class T, int L>
lanes::Kernel<T, L> LaneSolver<T, L>::kernel() const {
  const lanes::Kernels& best = lanes::bestKernels();
  const auto choose = [this](auto direct, auto overveld, auto xpbd) {
    if (options_.method == DynamicsMethod::VanOverveld) return overveld;
    return options_.method == DynamicsMethod::Xpbd ? xpbd : direct;
  };
  if constexpr (sizeof(T) == 8) {
    return choose(best.direct, best.overveld, best.xpbd);
  } else {
    return choose(best.directFloat, best.overveldFloat, best.xpbdFloat);
  }
}

template <class T, int L>
lanes::StepConstants LaneSolver<T, L>::constants(double timeStep, bool second) const {
  lanes::StepConstants c;
  switch (options_.method) {
    case DynamicsMethod::ArticulatedExplicit:
      c.scheme = lanes::Scheme::ArticulatedExplicit;
      break;
    case DynamicsMethod::ArticulatedImplicit:
      c.scheme = lanes::Scheme::ArticulatedImplicit;
      break;
    case DynamicsMethod::DirectBdf2:
      c.scheme = second ? lanes::Scheme::Bdf2 : lanes::Scheme::Euler;
      break;
    case DynamicsMethod::EnergyKeeping:
      c.scheme = lanes::Scheme::Midpoint;
      break;
    default:
      break;
  }
  c.step = timeStep;
  for (int k = 0; k < 3; ++k) c.gravity[k] = options_.gravity[k];
  c.maxNewton = options_.maxNewton;
  c.tolerance = options_.tolerance * meanLength_;
  c.iterations = options_.iterations;
  return c;
}

template <class T, int L>
Status LaneSolver<T, L>::check(const ChainState& s, double timeStep, const RootMotion& roots) const {
  if (!(timeStep > 0) || !std::isfinite(timeStep))
    return makeError(ErrorCode::InvalidArgument, "the time step is not positive");
  const std::size_t n = chains_.nodeCount(), t = chains_.treeCount();
  const bool fits = s.positions.size() == n && s.velocities.size() == n && s.previousPositions.size() == n &&
                    s.previousVelocities.size() == n && s.rootFrames.size() == t &&
                    s.quietSteps.size() == t && s.quietForces.size() == n;
  if (!fits) return makeError(ErrorCode::InvalidArgument, "the state does not belong to these chains");
  if ((!roots.positions.empty() && roots.positions.size() != t) ||
      (!roots.frames.empty() && roots.frames.size() != t))
    return makeError(ErrorCode::InvalidArgument, "there is not one root position or frame a tree");
  return {};
}

template <class T, int L>
Vec3 LaneSolver<T, L>::fieldForce(std::uint32_t node, const Vec3& position, const Vec3& velocity,
                                  Mat3& stiffness) const {
  Vec3 force = Vec3::Zero();
  stiffness.setZero();
  for (const ForceField* field : fields_) field->add(node, position, velocity, force, stiffness);
  return force;
}

template <class T, int L>
void LaneSolver<T, L>::begin(ChainState& state, std::span<ForceField* const> fields, double timeStep,
                             const RootMotion& roots, const Context& context) {
  start_ = &state;
  step_ = constants(timeStep, state.previousStep == timeStep);
  fallback_ = step_;
  fallback_.scheme = lanes::Scheme::Euler;
  makeScratch(context);
  fields_.clear();
  const NodeView view{state.positions, state.velocities, chains_.masses, chains_.radii};
  for (ForceField* field : fields) {
    field->prepare(view, state.time, timeStep, context);
    if (field->active()) fields_.push_back(field);
  }
  std::copy(state.positions.begin(), state.positions.end(), positions_.begin());
  std::copy(state.velocities.begin(), state.velocities.end(), velocities_.begin());
  for (std::uint32_t t = 0; t < chains_.treeCount(); ++t) {
    rootPositions_[t] =
        roots.positions.empty() ? state.positions[chains_.treeOffsets[t]] : roots.positions[t];
    rootFrames_[t] = roots.frames.empty() ? state.rootFrames[t] : roots.frames[t];
    treeFaults_[t] = lanes::LaneFault::None;
    newton_[t] = 0;
    if (!rootPositions_[t].allFinite() || !isFrame(rootFrames_[t]))
      treeFaults_[t] = lanes::LaneFault::NotFinite;
  }
  for (std::uint32_t t = 0; t < chains_.treeCount(); ++t) asleep_[t] = sleeps(t, timeStep);
}

template <class T, int L>
bool LaneSolver<T, L>::sleeps(std::uint32_t tree, double timeStep) const {
  const std::uint32_t root = chains_.treeOffsets[tree];
  if (options_.sleepSpeed == 0 || start_->quietSteps[tree] < std::uint32_t(options_.sleepSteps)) return false;
  if (rootPositions_[tree] != start_->positions[root] || rootFrames_[tree] != start_->rootFrames[tree])
    return false;
  if (fields_.empty()) return true;
  // A change that would bring a node to sleepSpeed within sleepSteps wakes the chain.
  const double wake = options_.sleepSpeed / (timeStep * options_.sleepSteps);
  Mat3 stiffness;
  for (std::uint32_t i = root; i < chains_.treeOffsets[tree + 1]; ++i) {
    const Vec3 force = fieldForce(i, start_->positions[i], Vec3::Zero(), stiffness);
    if (!((force - start_->quietForces[i]).norm() <= wake * chains_.masses[i])) return false;
  }
  return true;
}

template <class T, int L>
Result<StepReport> LaneSolver<T, L>::step(ChainState& state, std::span<ForceField* const> fields,
                                          double timeStep, const RootMotion& roots, const Context& context) {
  const Stopwatch watch;
  COIF_TRY(check(state, timeStep, roots));
  begin(state, fields, timeStep, roots, context);
  const int passes = laterals_.entries.empty() ? 1 : options_.lateralPasses;
  for (int pass = 0; pass < passes; ++pass) {
    std::size_t first = 0;
    for (const std::size_t last : colourEnds_) {
      solveColour(first, last, context);
      first = last;
    }
  }
  StepReport report;
  finish(state, timeStep, report);
  report.seconds = watch.seconds();
  return report;
}

template <class T, int L>
void LaneSolver<T, L>::solveColour(std::size_t first, std::size_t last, const Context& context) {
  Context all = context;
  all.cancel = nullptr;  // half a step would be none
  struct Args {
    LaneSolver* self;
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
void LaneSolver<T, L>::solveBlock(const LaneBlock& block, Scratch& scratch) {
  bool run[L], again[L];
  bool any = false, repeat = false;
  for (int l = 0; l < L; ++l) {
    const std::uint32_t tree = block.trees[l];
    run[l] = l < block.used && asleep_[tree] == 0 && treeFaults_[tree] != lanes::LaneFault::NotFinite;
    any |= run[l];
  }
  if (!any) return;
  lanes::Block<T, L> lane;
  FieldCall call{this, &block, scratch.work.data()};
  lane.context = &call;
  if (!fields_.empty()) lane.fields = &LaneSolver::callFields;
  gather(block, scratch, lane);
  for (int l = 0; l < L; ++l) lane.active[l] = T(run[l]);
  kernel()(lane, step_);
  for (int l = 0; l < L; ++l) {
    again[l] =
        run[l] && step_.scheme == lanes::Scheme::Midpoint && lane.fault[l] == lanes::LaneFault::NotConverged;
    repeat |= again[l];
    run[l] = run[l] && !again[l];
  }
  scatter(block, lane, run);
  if (!repeat) return;
  gather(block, scratch, lane);  // the midpoint's equations had no solution that Newton found
  for (int l = 0; l < L; ++l) lane.active[l] = T(again[l]);
  kernel()(lane, fallback_);
  for (int l = 0; l < L; ++l) {
    if (again[l] && lane.fault[l] == lanes::LaneFault::None) lane.fault[l] = lanes::LaneFault::NotConverged;
  }
  scatter(block, lane, again);
}

template <class T, int L>
Mat3 LaneSolver<T, L>::frameForStep(std::uint32_t tree) const {
  if (step_.scheme != lanes::Scheme::Midpoint || rootFrames_[tree] == start_->rootFrames[tree])
    return rootFrames_[tree];
  const Eigen::Quaterniond a(start_->rootFrames[tree]), b(rootFrames_[tree]);
  return a.slerp(0.5, b).toRotationMatrix();
}

template <class T, int L>
void LaneSolver<T, L>::gather(const LaneBlock& block, Scratch& scratch, lanes::Block<T, L>& out) {
  const ChainBin& bin = bins_[block.bin];
  out.nodes = std::int32_t(bin.parents.size());
  out.parents = bin.parents.data();
  out.slots = bin.slots.data();
  out.constants = block.constants.data();
  out.work = scratch.work.data();
  out.stashes = scratch.stashes.data();
  out.bend = bin.bend, out.curved = bin.curved, out.anyFree = bin.anyFree;
  for (int l = 0; l < L; ++l) {
    const std::uint32_t tree = block.trees[l];
    const Mat3 frame = frameForStep(tree);
    for (int k = 0; k < 9; ++k) out.rootAxes[k][l] = T(frame(k % 3, k / 3));
    out.freeRoot[l] = chains_.freeRoots[tree];
  }
  for (int n = 0; n < out.nodes; ++n) gatherNode(block, n, scratch.work[std::size_t(n)]);
  for (int l = 0; l < L; ++l) {
    for (int k = 0; k < 3; ++k) scratch.work[0].x[k][l] = T(rootPositions_[block.trees[l]][k]);
  }
}

template <class T, int L>
void LaneSolver<T, L>::gatherNode(const LaneBlock& block, int node, lanes::NodeWork<T, L>& work) const {
  const bool history = step_.scheme == lanes::Scheme::Bdf2;
  for (int l = 0; l < L; ++l) {
    const std::size_t i = chains_.treeOffsets[block.trees[l]] + std::size_t(node);
    const Vec3 pull = laterals_.entries.empty() || node == 0 ? Vec3::Zero() : lateralPull(std::uint32_t(i));
    for (int k = 0; k < 3; ++k) {
      work.x0[k][l] = T(start_->positions[i][k]);
      work.v0[k][l] = T(start_->velocities[i][k]);
      work.lateral[k][l] = T(pull[k]);
      if (!history) continue;
      work.xp[k][l] = T(start_->previousPositions[i][k]);
      work.vp[k][l] = T(start_->previousVelocities[i][k]);
    }
  }
}

// Σ k (d_neighbour ∓ rest): with |d| fixed, all that ½k|d − (d_neighbour ∓ rest)|² says of d.
template <class T, int L>
Vec3 LaneSolver<T, L>::lateralPull(std::uint32_t node) const {
  Vec3 pull = Vec3::Zero();
  for (std::uint32_t e = laterals_.offsets[node]; e < laterals_.offsets[node + 1]; ++e) {
    const LateralTable::Entry& entry = laterals_.entries[e];
    const Vec3 link = positions_[entry.other] - positions_[chains_.parents[entry.other]];
    pull += entry.stiffness * (link + rootFrames_[entry.tree] * entry.rest);
  }
  return pull;
}

template <class T, int L>
void LaneSolver<T, L>::callFields(void* context) {
  const FieldCall& call = *static_cast<const FieldCall*>(context);
  const LaneSolver& solver = *call.solver;
  const std::size_t nodes = solver.bins_[call.block->bin].parents.size();
  Mat3 stiffness;
  for (std::size_t n = 0; n < nodes; ++n) {
    lanes::NodeWork<T, L>& w = call.work[n];
    for (int l = 0; l < L; ++l) {
      const bool used = l < call.block->used;
      const auto i = std::uint32_t(solver.chains_.treeOffsets[call.block->trees[l]] + n);
      Vec3 force = Vec3::Zero();
      stiffness.setZero();
      if (used) {
        force = solver.fieldForce(i, Vec3(w.x[0][l], w.x[1][l], w.x[2][l]),
                                  Vec3(w.v[0][l], w.v[1][l], w.v[2][l]), stiffness);
      }
      for (int k = 0; k < 3; ++k) w.force[k][l] = T(force[k]);
      const double upper[6] = {stiffness(0, 0), stiffness(0, 1), stiffness(0, 2),
                               stiffness(1, 1), stiffness(1, 2), stiffness(2, 2)};
      for (int k = 0; k < 6; ++k) w.stiffness[k][l] = T(upper[k]);
    }
  }
}

template <class T, int L>
void LaneSolver<T, L>::scatter(const LaneBlock& block, const lanes::Block<T, L>& in, const bool* which) {
  const std::size_t nodes = bins_[block.bin].parents.size();
  for (int l = 0; l < L; ++l) {
    if (!which[l]) continue;
    const std::uint32_t tree = block.trees[l];
    treeFaults_[tree] = in.fault[l];
    newton_[tree] = std::max(newton_[tree], double(in.newtonSteps[l]));
    const std::size_t root = chains_.treeOffsets[tree];
    bool finite = true;
    for (std::size_t n = 0; n < nodes; ++n) {
      const lanes::NodeWork<T, L>& w = in.work[n];
      positions_[root + n] = Vec3(w.x[0][l], w.x[1][l], w.x[2][l]);
      velocities_[root + n] = Vec3(w.v[0][l], w.v[1][l], w.v[2][l]);
      finite &= positions_[root + n].allFinite() && velocities_[root + n].allFinite();
    }
    if (!finite) treeFaults_[tree] = lanes::LaneFault::NotFinite;
    // Neighbours must not see it before the step's end resets it.
    if (treeFaults_[tree] == lanes::LaneFault::NotFinite) reset(tree);
  }
}

// Rigidly with its root, at rest; in its rest shape if the state itself is spoilt.
template <class T, int L>
void LaneSolver<T, L>::reset(std::uint32_t tree) {
  const std::uint32_t root = chains_.treeOffsets[tree], end = chains_.treeOffsets[tree + 1];
  if (!rootPositions_[tree].allFinite()) {
    const Vec3& old = start_->positions[root];
    rootPositions_[tree] = old.allFinite() ? old : chains_.restPositions[root];
  }
  if (!isFrame(rootFrames_[tree])) rootFrames_[tree] = chains_.rootFrames[tree];
  bool usable = isFrame(start_->rootFrames[tree]);
  for (std::uint32_t i = root; i < end; ++i) usable &= start_->positions[i].allFinite();
  const std::vector<Vec3>& shape = usable ? start_->positions : chains_.restPositions;
  const Mat3 turn =
      rootFrames_[tree] * (usable ? start_->rootFrames[tree] : chains_.rootFrames[tree]).transpose();
  const bool isFree = chains_.freeRoots[tree] != 0;
  positions_[root] = isFree && usable ? start_->positions[root] : rootPositions_[tree];
  velocities_[root].setZero();
  for (std::uint32_t i = root + 1; i < end; ++i) {
    const std::uint32_t p = chains_.parents[i];
    Vec3 link = turn * (shape[i] - shape[p]);
    const double length = link.norm();
    link = length > 0 && std::isfinite(length) ? Vec3(link * (chains_.lengths[i] / length))
                                               : Vec3(rootFrames_[tree].col(2) * chains_.lengths[i]);
    positions_[i] = positions_[p] + link;
    velocities_[i].setZero();
  }
}

template <class T, int L>
void LaneSolver<T, L>::restQuietly(ChainState& state, std::uint32_t tree) {
  Mat3 stiffness;
  for (std::uint32_t i = chains_.treeOffsets[tree]; i < chains_.treeOffsets[tree + 1]; ++i) {
    velocities_[i].setZero();
    if (asleep_[tree] != 0 && fields_.empty()) continue;
    if (state.quietSteps[tree] == std::uint32_t(options_.sleepSteps))
      state.quietForces[i] = fieldForce(i, positions_[i], Vec3::Zero(), stiffness);
  }
}

template <class T, int L>
void LaneSolver<T, L>::finish(ChainState& state, double timeStep, StepReport& report) {
  faults_.clear();
  double newton = 0;
  for (std::uint32_t t = 0; t < chains_.treeCount(); ++t) {
    const std::uint32_t root = chains_.treeOffsets[t], end = chains_.treeOffsets[t + 1];
    if (treeFaults_[t] != lanes::LaneFault::None) {
      const bool finite = treeFaults_[t] == lanes::LaneFault::NotConverged;
      if (!finite) reset(t);
      faults_.push_back({t, finite ? ChainFaultKind::NotConverged : ChainFaultKind::NotFinite});
    }
    report.asleep += asleep_[t] != 0;
    report.solved += asleep_[t] == 0;
    newton += newton_[t];
    report.maxNewton = std::max(report.maxNewton, int(newton_[t]));
    if (options_.sleepSpeed == 0) continue;
    double speed = 0;
    for (std::uint32_t i = root; i < end; ++i) speed = std::max(speed, velocities_[i].squaredNorm());
    const bool quiet = speed <= options_.sleepSpeed * options_.sleepSpeed;
    const std::uint32_t most = std::uint32_t(options_.sleepSteps) + 1;
    state.quietSteps[t] = quiet ? std::min(state.quietSteps[t] + 1, most) : 0;
    if (state.quietSteps[t] >= std::uint32_t(options_.sleepSteps)) restQuietly(state, t);
  }
  report.meanNewton = report.solved > 0 ? newton / double(report.solved) : 0;
  report.faults = faults_;
  std::swap(state.previousPositions, state.positions);
  std::swap(state.previousVelocities, state.velocities);
  std::copy(positions_.begin(), positions_.end(), state.positions.begin());
  std::copy(velocities_.begin(), velocities_.end(), state.velocities.begin());
  std::copy(rootFrames_.begin(), rootFrames_.end(), state.rootFrames.begin());
  state.time += timeStep;
  state.previousStep = timeStep;
  for (const ChainFault& fault : faults_) {
    if (fault.kind == ChainFaultKind::NotFinite) forgetHistory(state, fault.tree);
  }
}

// A reset chain has been where it is, at rest.
template <class T, int L>
void LaneSolver<T, L>::forgetHistory(ChainState& state, std::uint32_t tree) const {
  for (std::uint32_t i = chains_.treeOffsets[tree]; i < chains_.treeOffsets[tree + 1]; ++i) {
    state.previousPositions[i] = state.positions[i];
    state.previousVelocities[i].setZero();
  }
}

template class LaneSolver<double, lanes::kDoubleLanes>;
template class LaneSolver<float, lanes::kFloatLanes>;

}  // namespace coif
