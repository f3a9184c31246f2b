// What acts on a simulation's chains, from its settings and its world.
#include <algorithm>
#include <cmath>

#include "simulate/simulation_impl.h"

namespace coif {

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

}  // namespace coif
