#include "coif/simulate/simulation.h"

#include <algorithm>
#include <cmath>

#include "simulate/binning.h"
#include "simulate/left_out.h"
#include "simulate/simulation_impl.h"
#include "simulate/simulation_state.h"

namespace coif {

namespace {

constexpr double kStandardGravity = 9.81;  // what droop refers to
constexpr double kMaxStepsPerFrame = 1e6;

}  // namespace

Status Simulation::Impl::makeChains(const Context& context) {
  ChainOptions options;
  if (settings.droop > 0) options.droop = settings.droop;
  options.gravity = kStandardGravity * perUnit();
  options.drag = settings.wind == WindKind::None ? settings.drag : 0;
  options.radius = settings.collide ? settings.thickness * perUnit() : 0;
  options.lateral = settings.lateral;
  if (settings.wisps > 0) {
    COIF_ASSIGN(wisps,
                makeWisps(mesh, {settings.wisps, settings.guidePoints, settings.seed}, world.head, context));
    std::vector<std::uint64_t> offsets;
    for (std::size_t g = 0; g <= wisps->guideCount(); ++g) offsets.push_back(g * wisps->points);
    COIF_ASSIGN(build, chainsFromCurves(wisps->guides, offsets, options));
    if (settings.lateral > 0) addWispSprings();
  } else {
    COIF_ASSIGN(build, chainsFromMesh(mesh, options));
  }
  if (build.chains.linkCount() == 0)
    return makeError(ErrorCode::Degenerate, "the hair mesh has no column of any length that could move");
  SolverOptions solverOptions;
  solverOptions.method = settings.method;
  solverOptions.gravity = -settings.gravity * perUnit() * up();
  solverOptions.tolerance = settings.tolerance;
  solverOptions.floatLanes = settings.singlePrecision;
  solverOptions.skipBending = settings.skipBending;
  solverOptions.sleepSpeed = settings.sleepSpeed * perUnit();
  solverOptions.sleepSteps = int(std::clamp(std::ceil(settings.sleepSeconds / stepSeconds()), 1.0, 1e9));
  COIF_ASSIGN(solver, makeSolver(build.chains, solverOptions));
  report.vertices = build.nodeOf.size();
  report.chains = build.chains.treeCount();
  report.links = build.chains.linkCount();
  report.limp = settings.skipBending ? simulate::limpTrees(build.chains) : 0;
  return {};
}

/// A wisp's guides hold together as neighbouring columns do.
void Simulation::Impl::addWispSprings() {
  ChainSet& chains = build.chains;
  const std::vector<std::uint32_t> treeOf = treeOfNodes(chains);
  const auto link = [&](std::uint32_t node) {
    return Vec3(chains.restPositions[node] - chains.restPositions[chains.parents[node]]);
  };
  for (const auto& guides : wisps->wisps) {
    for (int side = 0; side < 3; ++side) {
      const std::uint32_t g = guides[side], h = guides[(side + 1) % 3];
      for (std::uint32_t k = 1; k < wisps->points && g != h; ++k) {
        const std::uint32_t a = build.nodeOf[g * wisps->points + k], b = build.nodeOf[h * wisps->points + k];
        if (a == kNone || b == kNone || chains.parents[a] == kNone || chains.parents[b] == kNone) continue;
        const Vec3 rest = chains.rootFrames[treeOf[a]].transpose() * (link(b) - link(a));
        chains.laterals.push_back({a, b, settings.lateral, rest});
      }
    }
  }
}

void Simulation::Impl::rootAt(std::uint32_t source, double time, Vec3& position, Mat3& turn) const {
  if (!wisps) return path.root(source, time, position, turn);
  const WispSet::Root& root = wisps->roots[source / wisps->points];
  path.point(root.vertices, root.weights, wisps->guides[source], time, position, turn);
}

/// The modelled mesh where the motion begins.
void Simulation::Impl::start() {
  state = restState(build.chains);
  const RigidPose pose = path.pose(0);
  for (Vec3& p : state.positions) p = pose.world(p);
  moveRoots(0);
  for (std::size_t t = 0; t < build.chains.treeCount(); ++t) {
    // A deformed scalp takes each tree along with its root.
    const std::uint32_t root = build.chains.treeOffsets[t];
    Vec3 at;
    Mat3 turn;
    rootAt(build.chains.sources[root], 0, at, turn);
    const Vec3 rest = build.chains.restPositions[root];
    for (std::uint32_t i = root; i < build.chains.treeOffsets[t + 1]; ++i)
      state.positions[i] = at + turn * (build.chains.restPositions[i] - rest);
  }
  state.previousPositions = state.positions;
  state.rootFrames = rootFrames;
  gather();
}

void Simulation::Impl::moveRoots(double time) {
  const ChainSet& chains = build.chains;
  rootPositions.resize(chains.treeCount());
  rootFrames.resize(chains.treeCount());
  for (std::size_t t = 0; t < chains.treeCount(); ++t) {
    Mat3 turn;
    rootAt(chains.sources[chains.treeOffsets[t]], time, rootPositions[t], turn);
    rootFrames[t] = turn * chains.rootFrames[t];
  }
}

/// From `from` to `to`, in frames.
Status Simulation::Impl::step(double from, double to, double timeStep, const Context& context) {
  const RigidPose start = path.pose(from), end = path.pose(to);
  if (collisions) {
    for (std::size_t i = 0; i < withHead.size(); ++i)
      if (withHead[i]) collisions->setMotion(i, start, end);
  }
  if (fluid && band) {
    const RigidPose back = start * end.inverse();
    fluid->setObstacle({[this, end](const Vec3& p) {
                          double distance = 0;
                          Vec3 normal;
                          return band->sample(end.local(p), distance, normal) ? distance : 1e30;
                        },
                        [back, timeStep](const Vec3& p) { return Vec3((p - back.world(p)) / timeStep); }});
  }
  RootMotion roots;
  if (!path.still()) {
    moveRoots(to);
    roots = {rootPositions, rootFrames};
  }
  COIF_ASSIGN(const StepReport done, solver->step(state, fields, timeStep, roots, context));
  count(done);
  return {};
}

void Simulation::Impl::count(const StepReport& done) {
  ++report.steps;
  report.maxNewton = std::max(report.maxNewton, done.maxNewton);
  report.chainSteps += done.solved;
  report.asleep += done.asleep;
  report.inSingle = done.inSingle;
  newtonSum += done.meanNewton * double(done.solved);
  report.meanNewton = report.chainSteps > 0 ? newtonSum / double(report.chainSteps) : 0;
  for (const ChainFault& fault : done.faults)
    ++(fault.kind == ChainFaultKind::NotFinite ? report.resets : report.unconverged);
  for (std::size_t f = 0; f < fields.size(); ++f) {
    report.fields[f].steps += fields[f]->active();
    if (!fields[f]->active()) report.fields[f].idleReason = fields[f]->idleReason();
  }
  if (collisions) report.collidingNodes = std::max(report.collidingNodes, collisions->nearCount());
}

/// Vertices or guides' points where their nodes are; those without one are rigid with the head.
void Simulation::Impl::gather() {
  const RigidPose head = path.pose(double(frame));
  positions.resize(build.nodeOf.size());
  for (std::uint32_t v = 0; v < positions.size(); ++v) {
    const std::uint32_t node = build.nodeOf[v];
    if (node != kNone) {
      positions[v] = state.positions[node];
    } else if (wisps) {
      positions[v] = head.world(wisps->guides[v]);
    } else if (mesh.vertices()[v].layer == 0) {
      Mat3 turn;
      path.root(v, double(frame), positions[v], turn);
    } else {
      positions[v] = head.world(mesh.vertices()[v].position);
    }
  }
}

Simulation::Simulation(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Simulation::~Simulation() = default;

Result<std::unique_ptr<Simulation>> Simulation::create(const HairMesh& mesh, const DynamicsSettings& settings,
                                                       const SimulationWorld& world, const Context& context) {
  COIF_TRY(validate(settings));
  if (!(world.framesPerSecond > 0 && world.framesPerSecond <= 1e5))
    return makeError(ErrorCode::InvalidArgument, "frames a second must be above 0 and at most 100 000");
  if (!(world.metersPerUnit >= 1e-12 && world.metersPerUnit <= 1e12))
    return makeError(ErrorCode::InvalidArgument, "the scene's unit is no length");
  const double steps = std::ceil(1 / (world.framesPerSecond * settings.longestStep) - 1e-9);
  if (steps > kMaxStepsPerFrame)
    return makeError(ErrorCode::InvalidArgument, "a frame would take more than a million steps",
                     "longestStep");
  auto impl = std::make_unique<Impl>();
  impl->mesh = mesh;
  impl->settings = settings;
  impl->world = world;
  COIF_ASSIGN(impl->path, simulate::RootPath::create(mesh, world.motion));
  impl->report.stepsPerFrame = std::max(1, int(steps));
  COIF_TRY(impl->makeChains(context));
  COIF_TRY(impl->makeCollisions(context));
  COIF_TRY(impl->makeAir());
  impl->makeRepulsion();
  impl->start();
  const double longest = impl->stepSeconds();
  const auto settling = std::size_t(std::ceil(settings.settleSeconds / longest));
  for (std::size_t s = 0; s < settling; ++s) {
    if (context.cancelled()) return makeError(ErrorCode::Cancelled, "stopped while the hair settled");
    COIF_TRY(impl->step(0, 0, longest, context));
  }
  if (settling > 0) impl->gather();
  return std::unique_ptr<Simulation>(new Simulation(std::move(impl)));
}

std::size_t Simulation::frame() const {
  return impl_->frame;
}
std::span<const Vec3> Simulation::positions() const {
  return impl_->positions;
}
RigidPose Simulation::pose() const {
  return impl_->path.pose(double(impl_->frame));
}
std::shared_ptr<const DistanceBand> Simulation::band() const {
  return impl_->band;
}

const SimulationReport& Simulation::report() const {
  return impl_->report;
}

std::vector<LeftOut> Simulation::leftOut() const {
  return simulate::leftOut(impl_->settings, impl_->report);
}

Status Simulation::advance(const Context& context) {
  const Stopwatch watch;
  Impl& s = *impl_;
  const int steps = s.report.stepsPerFrame;
  const double timeStep = s.stepSeconds();
  const std::vector<std::byte> before = context.cancel ? state() : std::vector<std::byte>();
  for (int i = 0; i < steps; ++i) {
    if (context.cancelled()) {
      COIF_TRY(restore(before));
      return makeError(ErrorCode::Cancelled, "stopped between frames", "frame " + std::to_string(s.frame));
    }
    const double from = double(s.frame) + double(i) / steps;
    COIF_TRY(s.step(from, double(s.frame) + double(i + 1) / steps, timeStep, context));
  }
  ++s.frame;
  s.gather();
  ++s.report.frames;
  s.report.maxStretch = std::max(s.report.maxStretch, maxStretch(s.build.chains, s.state.positions));
  s.report.seconds += watch.seconds();
  return {};
}

std::vector<std::byte> Simulation::state() const {
  simulate::StateWriter out;
  out.add(std::uint64_t(impl_->frame));
  const ChainState& c = impl_->state;
  for (const auto* points :
       {&c.positions, &c.velocities, &c.previousPositions, &c.previousVelocities, &c.quietForces})
    out.add(std::span<const Vec3>(*points));
  out.add(std::span<const Mat3>(c.rootFrames));
  out.add(std::span<const std::uint32_t>(c.quietSteps));
  out.add(c.time);
  out.add(c.previousStep);
  const std::vector<double> air = impl_->fluid ? impl_->fluid->state() : std::vector<double>();
  out.add(std::span<const double>(air));
  return std::move(out).bytes();
}

Status Simulation::restore(std::span<const std::byte> bytes) {
  simulate::StateReader in(bytes);
  std::uint64_t frame = 0;
  ChainState c;
  std::vector<double> air;
  in.take(frame);
  for (auto* points :
       {&c.positions, &c.velocities, &c.previousPositions, &c.previousVelocities, &c.quietForces})
    in.take(*points);
  in.take(c.rootFrames);
  in.take(c.quietSteps);
  in.take(c.time);
  in.take(c.previousStep);
  in.take(air);
  const ChainState& now = impl_->state;
  const bool fits = in.complete() && c.positions.size() == now.positions.size() &&
                    c.velocities.size() == now.velocities.size() &&
                    c.previousPositions.size() == now.previousPositions.size() &&
                    c.previousVelocities.size() == now.previousVelocities.size() &&
                    c.rootFrames.size() == now.rootFrames.size() &&
                    c.quietSteps.size() == now.quietSteps.size() &&
                    c.quietForces.size() == now.quietForces.size() && frame < (std::uint64_t{1} << 40);
  if (!fits)
    return makeError(ErrorCode::Malformed, "the stored state does not fit this hair mesh and these settings");
  if (impl_->fluid) {
    COIF_TRY(impl_->fluid->restore(air));
  } else if (!air.empty()) {
    return makeError(ErrorCode::Malformed, "the stored state holds air that this scene does not have");
  }
  impl_->state = std::move(c);
  impl_->frame = std::size_t(frame);
  impl_->gather();
  return {};
}

}  // namespace coif
