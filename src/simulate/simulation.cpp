#include "coif/simulate/simulation.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

#include "coif/base/report.h"
#include "coif/simulate/collisions.h"
#include "coif/simulate/forces.h"
#include "coif/simulate/repulsion.h"
#include "simulate/root_motion.h"
#include "simulate/simulation_state.h"

namespace coif {

namespace {

constexpr double kStandardGravity = 9.81;  // what droop refers to
constexpr double kMaxStepsPerFrame = 1e6;

}  // namespace

struct Simulation::Impl {
  HairMesh mesh;
  DynamicsSettings settings;
  SimulationWorld world;
  simulate::RootPath path;
  ChainBuild build;
  std::unique_ptr<Solver> solver;
  ChainState state;
  std::size_t frame = 0;
  std::vector<Vec3> positions;

  std::shared_ptr<const DistanceBand> band;
  std::vector<std::unique_ptr<Collider>> capsules;
  std::vector<std::uint8_t> withHead;  // by collider of the collision field
  std::unique_ptr<CollisionField> collisions;
  std::unique_ptr<Air> air;
  FluidWind* fluid = nullptr;  // the air, when it is one
  std::unique_ptr<DragField> drag;
  std::unique_ptr<RepulsionField> repulsion;
  std::vector<ForceField*> fields;
  std::vector<Vec3> rootPositions;
  std::vector<Mat3> rootFrames;
  SimulationReport report;
  double newtonSum = 0;

  double perUnit() const { return 1 / world.metersPerUnit; }
  Vec3 up() const { return world.upAxis == UpAxis::Z ? Vec3(Vec3::UnitZ()) : Vec3(Vec3::UnitY()); }

  Status makeChains();
  Status makeCollisions(const Context& context);
  Status makeAir();
  void makeRepulsion();
  void addField(ForceField* field, const char* name);
  void start();
  void moveRoots(double time);
  Status step(double from, double to, double timeStep, const Context& context);
  void gather();
  void count(const StepReport& stepReport);
};

Status Simulation::Impl::makeChains() {
  ChainOptions options;
  if (settings.droop > 0) options.droop = settings.droop;
  options.gravity = kStandardGravity * perUnit();
  options.drag = settings.wind == WindKind::None ? settings.drag : 0;
  options.radius = settings.collide ? settings.thickness * perUnit() : 0;
  options.lateral = settings.lateral;
  COIF_ASSIGN(build, chainsFromMesh(mesh, options));
  if (build.chains.linkCount() == 0)
    return makeError(ErrorCode::Degenerate, "the hair mesh has no column of any length that could move");
  SolverOptions solverOptions;
  solverOptions.method = settings.method;
  solverOptions.gravity = -settings.gravity * perUnit() * up();
  COIF_ASSIGN(solver, makeSolver(build.chains, solverOptions));
  report.vertices = mesh.vertices().size();
  report.chains = build.chains.treeCount();
  report.links = build.chains.linkCount();
  return {};
}

Status Simulation::Impl::makeCollisions(const Context& context) {
  if (!settings.collide || (!world.head && settings.capsules.empty())) return {};
  const double thickness = settings.thickness * perUnit();
  CollisionOptions options;
  options.stiffness = settings.contactStiffness;
  options.friction = settings.friction;
  options.slipSpeed = 1e-3 * perUnit();
  collisions = std::make_unique<CollisionField>(options);
  if (world.head) {
    DistanceBandOptions bandOptions;
    bandOptions.reach = std::max(3 * world.head->size() / 64, 2 * thickness);
    if (world.band && world.band->reach() >= bandOptions.reach) {
      band = world.band;
    } else {
      COIF_ASSIGN(DistanceBand made, DistanceBand::build(*world.head, bandOptions, context));
      band = std::make_shared<const DistanceBand>(std::move(made));
    }
    report.band = band->report();
    collisions->addCollider(*band);
    withHead.push_back(1);
  }
  for (const BodyCapsule& capsule : settings.capsules) {
    capsules.push_back(std::make_unique<CapsuleCollider>(capsule.a, capsule.b, capsule.radius));
    collisions->addCollider(*capsules.back());
    withHead.push_back(capsule.withHead);
  }
  // What was modelled closer than the thickness stays as close; what lies beneath the skin is left alone.
  ChainSet& chains = build.chains;
  std::vector<std::uint8_t> exempt(chains.nodeCount(), 0);
  for (std::size_t i = 0; i < chains.nodeCount(); ++i) {
    exempt[i] = chains.parents[i] == kNone;
    double nearest = thickness;
    const auto look = [&](const Collider& collider) {
      double distance = 0;
      Vec3 normal;
      if (collider.sample(chains.restPositions[i], distance, normal)) nearest = std::min(nearest, distance);
    };
    if (band) look(*band);
    for (const auto& capsule : capsules) look(*capsule);
    chains.radii[i] = std::clamp(nearest, 0.0, thickness);
    if (nearest < -thickness) exempt[i] = 1;
  }
  collisions->exempt(std::move(exempt));
  addField(collisions.get(), "collisions");
  return {};
}

Status Simulation::Impl::makeAir() {
  if (settings.wind == WindKind::None) return {};
  const Vec3 mean = settings.windVelocity * perUnit();
  if (settings.wind == WindKind::Constant) air = std::make_unique<ConstantWind>(mean);
  if (settings.wind == WindKind::Gusts) {
    air = std::make_unique<GustyWind>(GustOptions{mean, settings.gustSpeed * perUnit(),
                                                  settings.gustSize * perUnit(), settings.gustSeconds,
                                                  settings.seed});
  }
  if (settings.wind == WindKind::Fluid) {
    const double thickness = std::max(settings.cell * perUnit(), 1e-12);
    FluidOptions options;
    options.mean = mean;
    options.cells = settings.airCells;
    std::vector<Vec3> points = build.chains.restPositions;
    if (band)
      points.insert(points.end(), world.head->mesh().positions.begin(), world.head->mesh().positions.end());
    const Box rest = bounds(points);
    Vec3 lo = rest.lo, hi = rest.hi;
    for (std::size_t f = 0; f < path.frames(); ++f) {
      for (int corner = 0; corner < 8; ++corner) {
        const Vec3 at(corner & 1 ? rest.hi[0] : rest.lo[0], corner & 2 ? rest.hi[1] : rest.lo[1],
                      corner & 4 ? rest.hi[2] : rest.lo[2]);
        lo = lo.cwiseMin(path.pose(double(f)).world(at));
        hi = hi.cwiseMax(path.pose(double(f)).world(at));
      }
    }
    const Vec3 margin = Vec3::Constant(0.3 * rest.diagonal());
    options.lo = lo - margin;
    options.hi = hi + margin;
    // The rate is meant for the densest hair of the modelled style, on the density grid's cells.
    RepulsionField probe({0, 0, thickness, 6, 1});
    const std::vector<Vec3> still(build.chains.nodeCount(), Vec3::Zero());
    probe.prepare({build.chains.restPositions, still, build.chains.masses, build.chains.radii}, 0, 1, {});
    options.hairDrag = probe.maxDensity() > 0 ? settings.shelter / probe.maxDensity() : 0;
    COIF_ASSIGN(auto made, FluidWind::create(options));
    fluid = made.get();
    air = std::move(made);
  }
  drag = std::make_unique<DragField>(DragOptions{settings.drag, 0}, air.get());
  addField(drag.get(), "wind");
  return {};
}

void Simulation::Impl::makeRepulsion() {
  if (settings.repulsion <= 0 && settings.hairFriction <= 0) return;
  RepulsionOptions options{0, 0, settings.cell * perUnit(), 6, 1};
  RepulsionField probe(options);
  const std::vector<Vec3> still(build.chains.nodeCount(), Vec3::Zero());
  probe.prepare({build.chains.restPositions, still, build.chains.masses, build.chains.radii}, 0, 1, {});
  options.restDensity = settings.density * probe.maxDensity();
  const double speed = settings.repulsion * perUnit();
  options.stiffness = probe.maxDensity() > 0 ? speed * speed / probe.maxDensity() : 0;  // p = c² (ρ − ρ0)
  options.friction = settings.hairFriction;
  repulsion = std::make_unique<RepulsionField>(options);
  addField(repulsion.get(), "repulsion");
}

void Simulation::Impl::addField(ForceField* field, const char* name) {
  fields.push_back(field);
  report.fields.push_back({name, 0, ""});
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
    path.root(build.chains.sources[root], 0, at, turn);
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
    path.root(chains.sources[chains.treeOffsets[t]], time, rootPositions[t], turn);
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
  newtonSum += done.meanNewton;
  report.meanNewton = newtonSum / double(report.steps);
  for (const ChainFault& fault : done.faults)
    ++(fault.kind == ChainFaultKind::NotFinite ? report.resets : report.unconverged);
  for (std::size_t f = 0; f < fields.size(); ++f) {
    report.fields[f].steps += fields[f]->active();
    if (!fields[f]->active()) report.fields[f].idleReason = fields[f]->idleReason();
  }
  if (collisions) report.collidingNodes = std::max(report.collidingNodes, collisions->nearCount());
}

/// Vertices where their nodes are; those without one are rigid with the head.
void Simulation::Impl::gather() {
  const RigidPose head = path.pose(double(frame));
  positions.resize(mesh.vertices().size());
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const std::uint32_t node = build.nodeOf[v];
    if (node != kNone) {
      positions[v] = state.positions[node];
    } else if (mesh.vertices()[v].layer == 0) {
      Mat3 turn;
      path.root(std::uint32_t(v), double(frame), positions[v], turn);
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
  COIF_TRY(impl->makeChains());
  COIF_TRY(impl->makeCollisions(context));
  COIF_TRY(impl->makeAir());
  impl->makeRepulsion();
  impl->start();
  const double longest = 1 / (world.framesPerSecond * impl->report.stepsPerFrame);
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

Status Simulation::advance(const Context& context) {
  const Stopwatch watch;
  Impl& s = *impl_;
  const int steps = s.report.stepsPerFrame;
  const double timeStep = 1 / (s.world.framesPerSecond * steps);
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
