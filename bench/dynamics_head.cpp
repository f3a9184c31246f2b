#include "bench/dynamics_head.h"

#include <cmath>
#include <numbers>

#include "coif/scalp/surface.h"

namespace coif {

namespace {

constexpr double kRadius = 0.1, kLength = 0.3, kCell = 0.015;

PolygonMesh sphere(int rings, int sectors) {
  PolygonMesh mesh;
  const auto point = [&](int ring, int sector) {
    const double polar = std::numbers::pi * ring / rings, turn = 2 * std::numbers::pi * sector / sectors;
    return Vec3(std::sin(polar) * std::cos(turn), std::cos(polar), -std::sin(polar) * std::sin(turn));
  };
  mesh.positions = {Vec3(0, kRadius, 0), Vec3(0, -kRadius, 0)};
  for (int ring = 1; ring < rings; ++ring)
    for (int sector = 0; sector < sectors; ++sector) mesh.positions.push_back(kRadius * point(ring, sector));
  const auto vertex = [&](int ring, int sector) -> std::uint32_t {
    if (ring == 0 || ring == rings) return ring == 0 ? 0 : 1;
    return std::uint32_t(2 + (ring - 1) * sectors + sector % sectors);
  };
  for (int ring = 0; ring < rings; ++ring) {
    for (int sector = 0; sector < sectors; ++sector) {
      const std::uint32_t a = vertex(ring, sector), b = vertex(ring + 1, sector),
                          c = vertex(ring + 1, sector + 1), d = vertex(ring, sector + 1);
      mesh.corners.insert(mesh.corners.end(), {a, b});
      if (c != b) mesh.corners.push_back(c);
      if (d != a) mesh.corners.push_back(d);
      mesh.faceOffsets.push_back(std::uint32_t(mesh.corners.size()));
    }
  }
  return mesh;
}

ChainSet hairs(std::size_t trees, std::size_t links) {
  std::vector<Vec3> points;
  std::vector<std::uint64_t> offsets{0};
  for (std::size_t t = 0; t < trees; ++t) {  // a spiral of equal areas, from the crown down
    const double height = 1 - 1.2 * (double(t) + 0.5) / double(trees), turn = 2.399963229728653 * double(t);
    const double across = std::sqrt(1 - height * height);
    const Vec3 normal(across * std::cos(turn), height, across * std::sin(turn));
    for (std::size_t k = 0; k <= links; ++k)
      points.push_back(normal * (kRadius + 0.002 + kLength * double(k) / double(links)));
    offsets.push_back(points.size());
  }
  ChainOptions options;
  options.droop = 1;
  options.radius = 0.002;
  return chainsFromCurves(points, offsets, options).value().chains;
}

/// Acts whatever the field says.
struct Kept final : ForceField {
  ForceField* field;
  explicit Kept(ForceField* f) : field(f) {}
  void prepare(const NodeView& start, double time, double timeStep, const Context& context) override {
    field->prepare(start, time, timeStep, context);
  }
  void add(std::uint32_t node, const Vec3& x, const Vec3& v, Vec3& force, Mat3& stiffness) const override {
    field->add(node, x, v, force, stiffness);
  }
  double energy(std::uint32_t node, const Vec3& x) const override { return field->energy(node, x); }
};

}  // namespace

HeadProblem::HeadProblem(const Options& options)
    : options_(options), chains_(hairs(options.trees, options.links)), state_(restState(chains_)) {
  SolverOptions solver;
  solver.gravity = Vec3(0, -9.81, 0);
  solver.tolerance = 1e-4;
  solver_ = makeSolver(chains_, solver).value();

  DistanceBandOptions band;
  band.cell = 0.006;
  band_ = DistanceBand::build(Surface(sphere(24, 48)), band).value();
  collisions_ = std::make_unique<CollisionField>(CollisionOptions{});
  collisions_->addCollider(*band_, {Mat3::Identity(), Vec3(0, -options.headAway, 0)});
  fields_.push_back(collisions_.get());

  RepulsionOptions repulsion{0, 0, kCell, 6, 1};
  RepulsionField probe(repulsion);
  const std::vector<Vec3> still(chains_.nodeCount(), Vec3::Zero());
  probe.prepare({chains_.restPositions, still, chains_.masses, chains_.radii}, 0, 1, {});
  repulsion.restDensity = options.density * probe.maxDensity();
  repulsion.stiffness = options.stiffness / probe.maxDensity();
  repulsion.friction = 0;  // 1 only made the probe look
  repulsion_ = std::make_unique<RepulsionField>(repulsion);
  fields_.push_back(repulsion_.get());

  if (options.fluid) {
    FluidOptions fluid;
    fluid.lo = Vec3(-0.6, -0.6, -0.6);
    fluid.hi = Vec3(0.6, 0.6, 0.6);
    fluid.mean = Vec3(2, 0, 0);
    fluid.cells = 12;
    fluid.hairDrag = 50 / probe.maxDensity();
    air_ = FluidWind::create(fluid, {[this](const Vec3& p) {
                                       double distance = 0;
                                       Vec3 normal;
                                       return band_->sample(p, distance, normal) ? distance : 1e30;
                                     },
                                     {}})
               .value();
  }
  drag_ = std::make_unique<DragField>(DragOptions{2, 0}, air_.get());
  fields_.push_back(drag_.get());
  if (!options.keepCollisions) return;
  kept_ = std::make_unique<Kept>(collisions_.get());
  fields_[0] = kept_.get();
}

StepReport HeadProblem::step(double timeStep) {
  Context context;
  context.threads = options_.threads;
  return solver_->step(state_, fields_, timeStep, {}, context).value();
}

}  // namespace coif
