#include "simulate/chain_stepper.h"

#include <algorithm>
#include <cmath>

#include "coif/base/report.h"
#include "simulate/binning.h"

namespace coif {

namespace {

bool isFrame(const Mat3& m) {
  return m.allFinite() && (m.transpose() * m - Mat3::Identity()).norm() < 1e-3;
}

lanes::Scheme schemeOf(DynamicsMethod method, bool second) {
  switch (method) {
    case DynamicsMethod::ArticulatedExplicit:
      return lanes::Scheme::ArticulatedExplicit;
    case DynamicsMethod::ArticulatedImplicit:
      return lanes::Scheme::ArticulatedImplicit;
    case DynamicsMethod::DirectBdf2:
      return second ? lanes::Scheme::Bdf2 : lanes::Scheme::Euler;
    case DynamicsMethod::EnergyKeeping:
      return lanes::Scheme::Midpoint;
    default:
      return lanes::Scheme::Euler;
  }
}

}  // namespace

LateralTable lateralTable(const ChainSet& chains) {
  LateralTable table;
  if (chains.laterals.empty()) return table;
  const std::vector<std::uint32_t> treeOf = treeOfNodes(chains);
  table.offsets.assign(chains.nodeCount() + 1, 0);
  for (const LateralSpring& s : chains.laterals) ++table.offsets[s.a + 1], ++table.offsets[s.b + 1];
  for (std::size_t i = 0; i < chains.nodeCount(); ++i) table.offsets[i + 1] += table.offsets[i];
  table.entries.resize(table.offsets.back());
  std::vector<std::uint32_t> next(table.offsets.begin(), table.offsets.end() - 1);
  for (const LateralSpring& s : chains.laterals) {
    table.entries[next[s.a]++] = {s.b, treeOf[s.a], s.stiffness, -s.rest};
    table.entries[next[s.b]++] = {s.a, treeOf[s.a], s.stiffness, s.rest};
  }
  return table;
}

ChainStepper::ChainStepper(const ChainSet& chains, const SolverOptions& options)
    : chains_(chains), options_(options), laterals_(lateralTable(chains)) {
  double sum = 0;
  for (std::size_t i = 0; i < chains.nodeCount(); ++i)
    sum += chains.parents[i] == kNone ? 0 : chains.lengths[i];
  meanLength_ = chains.linkCount() > 0 ? sum / double(chains.linkCount()) : 1;
  positions_.resize(chains.nodeCount());
  velocities_.resize(chains.nodeCount());
  const std::size_t trees = chains.treeCount();
  rootPositions_.resize(trees);
  rootFrames_.resize(trees);
  knownFrames_.assign(trees, Mat3::Identity());
  treeFaults_.resize(trees);
  newton_.resize(trees);
  lastMove_.resize(trees);
  asleep_.resize(trees);
  faults_.reserve(trees);
}

lanes::StepConstants ChainStepper::constants(double timeStep, bool second) const {
  lanes::StepConstants c;
  c.scheme = schemeOf(options_.method, second);
  c.step = timeStep;
  for (int k = 0; k < 3; ++k) c.gravity[k] = options_.gravity[k];
  c.maxNewton = options_.maxNewton;
  c.tolerance = options_.tolerance * meanLength_;
  c.iterations = options_.iterations;
  return c;
}

Status ChainStepper::check(const ChainState& s, double timeStep, const RootMotion& roots) const {
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

Vec3 ChainStepper::fieldForce(std::uint32_t node, const Vec3& position, const Vec3& velocity,
                              Mat3& stiffness) const {
  Vec3 force = Vec3::Zero();
  stiffness.setZero();
  for (const ForceField* field : fields_) field->add(node, position, velocity, force, stiffness);
  return force;
}

Vec3 ChainStepper::quietForce(std::uint32_t node, const Vec3& position) const {
  Mat3 stiffness;
  Vec3 force = fieldForce(node, position, Vec3::Zero(), stiffness);
  if (!laterals_.entries.empty() && chains_.parents[node] != kNone) force += lateralPull(node);
  return force;
}

bool ChainStepper::usableFrame(std::uint32_t tree) {
  if (rootFrames_[tree] == knownFrames_[tree]) return true;
  if (!isFrame(rootFrames_[tree])) return false;
  knownFrames_[tree] = rootFrames_[tree];
  return true;
}

void ChainStepper::begin(ChainState& state, std::span<ForceField* const> fields, double timeStep,
                         const RootMotion& roots, const Context& context) {
  start_ = &state;
  step_ = constants(timeStep, state.previousStep == timeStep);
  fallback_ = step_;
  fallback_.scheme = lanes::Scheme::Euler;
  fields_.clear();
  const NodeView view{state.positions, state.velocities, chains_.masses, chains_.radii};
  for (ForceField* field : fields) {
    field->prepare(view, state.time, timeStep, context);
    if (field->active()) fields_.push_back(field);
  }
  rootsMove_ = !roots.positions.empty() || !roots.frames.empty();
  for (std::uint32_t t = 0; t < chains_.treeCount(); ++t) {
    rootPositions_[t] =
        roots.positions.empty() ? state.positions[chains_.treeOffsets[t]] : roots.positions[t];
    rootFrames_[t] = roots.frames.empty() ? state.rootFrames[t] : roots.frames[t];
    const bool good = rootPositions_[t].allFinite() && usableFrame(t);
    treeFaults_[t] = good ? lanes::LaneFault::None : lanes::LaneFault::NotFinite;
    newton_[t] = 0;
    asleep_[t] = 0;
  }
  const auto stay = [&](std::uint32_t t) {
    const std::uint32_t first = chains_.treeOffsets[t], end = chains_.treeOffsets[t + 1];
    std::copy(&state.positions[first], &state.positions[first] + (end - first), &positions_[first]);
    std::copy(&state.velocities[first], &state.velocities[first] + (end - first), &velocities_[first]);
  };
  const bool seen = !laterals_.entries.empty();  // by neighbours
  for (std::uint32_t t = 0; t < chains_.treeCount() && seen; ++t) stay(t);
  for (std::uint32_t t = 0; t < chains_.treeCount(); ++t) {
    asleep_[t] = sleeps(t, timeStep);
    if (!seen && !runs(t)) stay(t);
  }
}

bool ChainStepper::sleeps(std::uint32_t tree, double timeStep) const {
  if (options_.sleepSpeed == 0 || start_->quietSteps[tree] < std::uint32_t(options_.sleepSteps)) return false;
  const std::uint32_t root = chains_.treeOffsets[tree];
  if (rootPositions_[tree] != start_->positions[root] || rootFrames_[tree] != start_->rootFrames[tree])
    return false;
  if (fields_.empty() && laterals_.entries.empty()) return true;
  // A change that would bring a node to sleepSpeed within sleepSteps wakes the chain.
  const double wake = options_.sleepSpeed / (timeStep * options_.sleepSteps);
  for (std::uint32_t i = root; i < chains_.treeOffsets[tree + 1]; ++i) {
    const Vec3 force = quietForce(i, start_->positions[i]);
    if (!((force - start_->quietForces[i]).norm() <= wake * chains_.masses[i])) return false;
  }
  return true;
}

Result<StepReport> ChainStepper::step(ChainState& state, std::span<ForceField* const> fields, double timeStep,
                                      const RootMotion& roots, const Context& context) {
  const Stopwatch watch;
  COIF_TRY(check(state, timeStep, roots));
  begin(state, fields, timeStep, roots, context);
  const int passes = laterals_.entries.empty() ? 1 : options_.lateralPasses;
  for (int pass = 0; pass < passes; ++pass) sweep(context);
  StepReport report;
  finish(state, timeStep, report);
  report.seconds = watch.seconds();
  return report;
}

Mat3 ChainStepper::frameForStep(std::uint32_t tree) const {
  if (!rootsMove_ || step_.scheme != lanes::Scheme::Midpoint || rootFrames_[tree] == start_->rootFrames[tree])
    return rootFrames_[tree];
  const Eigen::Quaterniond a(start_->rootFrames[tree]), b(rootFrames_[tree]);
  return a.slerp(0.5, b).toRotationMatrix();
}

bool ChainStepper::driven(std::uint32_t tree) const {
  return rootsMove_ && (rootPositions_[tree] != start_->positions[chains_.treeOffsets[tree]] ||
                        rootFrames_[tree] != start_->rootFrames[tree]);
}

// Σ k (d_neighbour ∓ rest): with |d| fixed, all that ½k|d − (d_neighbour ∓ rest)|² says of d.
Vec3 ChainStepper::lateralPull(std::uint32_t node) const {
  Vec3 pull = Vec3::Zero();
  for (std::uint32_t e = laterals_.offsets[node]; e < laterals_.offsets[node + 1]; ++e) {
    const LateralTable::Entry& entry = laterals_.entries[e];
    const Vec3 link = positions_[entry.other] - positions_[chains_.parents[entry.other]];
    pull += entry.stiffness * (link + rootFrames_[entry.tree] * entry.rest);
  }
  return pull;
}

// Rigidly with its root, at rest; in its rest shape if the state itself is spoilt.
void ChainStepper::reset(std::uint32_t tree) {
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

void ChainStepper::watchSleep(ChainState& state, std::uint32_t tree) {
  double speed = 0;
  for (std::uint32_t i = chains_.treeOffsets[tree]; i < chains_.treeOffsets[tree + 1]; ++i)
    speed = std::max(speed, velocities_[i].squaredNorm());
  const bool quiet = speed <= options_.sleepSpeed * options_.sleepSpeed;
  const std::uint32_t most = std::uint32_t(options_.sleepSteps) + 1;
  state.quietSteps[tree] = quiet ? std::min(state.quietSteps[tree] + 1, most) : 0;
  if (state.quietSteps[tree] >= std::uint32_t(options_.sleepSteps)) restQuietly(state, tree);
}

void ChainStepper::restQuietly(ChainState& state, std::uint32_t tree) {
  for (std::uint32_t i = chains_.treeOffsets[tree]; i < chains_.treeOffsets[tree + 1]; ++i) {
    velocities_[i].setZero();
    if (state.quietSteps[tree] == std::uint32_t(options_.sleepSteps))
      state.quietForces[i] = quietForce(i, positions_[i]);
  }
}

void ChainStepper::finish(ChainState& state, double timeStep, StepReport& report) {
  faults_.clear();
  double newton = 0;
  for (std::uint32_t t = 0; t < chains_.treeCount(); ++t) {
    if (treeFaults_[t] != lanes::LaneFault::None) {
      const bool finite = treeFaults_[t] == lanes::LaneFault::NotConverged;
      if (!finite) reset(t);
      faults_.push_back({t, finite ? ChainFaultKind::NotConverged : ChainFaultKind::NotFinite,
                         finite ? lastMove_[t] / meanLength_ : 0});
    }
    report.asleep += asleep_[t] != 0;
    report.solved += asleep_[t] == 0;
    newton += newton_[t];
    report.maxNewton = std::max(report.maxNewton, int(newton_[t]));
    if (options_.sleepSpeed > 0) watchSleep(state, t);
  }
  report.meanNewton = report.solved > 0 ? newton / double(report.solved) : 0;
  report.inSingle = inSingle_;
  report.faults = faults_;
  std::swap(state.previousPositions, state.positions);
  std::swap(state.previousVelocities, state.velocities);
  std::swap(state.positions, positions_);  // what the step before left is written anew in the next
  std::swap(state.velocities, velocities_);
  std::copy(rootFrames_.begin(), rootFrames_.end(), state.rootFrames.begin());
  state.time += timeStep;
  state.previousStep = timeStep;
  for (const ChainFault& fault : faults_) {
    if (fault.kind == ChainFaultKind::NotFinite) forgetHistory(state, fault.tree);
  }
}

// A reset chain has been where it is, at rest.
void ChainStepper::forgetHistory(ChainState& state, std::uint32_t tree) const {
  for (std::uint32_t i = chains_.treeOffsets[tree]; i < chains_.treeOffsets[tree + 1]; ++i) {
    state.previousPositions[i] = state.positions[i];
    state.previousVelocities[i].setZero();
  }
}

}  // namespace coif
