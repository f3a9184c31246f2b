// Hair meshes in motion: rest, heads that move, resuming, draping.
#include "coif/simulate/simulation.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "coif/hairmesh/history.h"
#include "coif/scalp/example_head.h"
#include "simulate/mesh_samples.h"

namespace coif {
namespace {

using samples::centimetres, samples::patch;

Mat3 about(const Vec3& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

std::vector<Vec3> run(Simulation& simulation, int frames, const Context& context = {}) {
  for (int f = 0; f < frames; ++f) {
    const Status done = simulation.advance(context);
    EXPECT_TRUE(done.ok()) << done.error().text();
  }
  return {simulation.positions().begin(), simulation.positions().end()};
}

TEST(Simulation, HangingColumnsStayWhereTheyHang) {
  const HairMesh mesh = patch(Vec3(0, -1, 0));
  auto simulation = Simulation::create(mesh, {}, centimetres());
  ASSERT_TRUE(simulation.ok()) << simulation.error().text();
  const auto positions = run(**simulation, 24);
  // Straight down is an equilibrium: only Newton's tolerance, 1e-9 of a link, is left.
  for (std::size_t v = 0; v < positions.size(); ++v)
    EXPECT_LE((positions[v] - mesh.vertices()[v].position).norm(), 1e-8);
}

TEST(Simulation, LimpColumnsFallAndKeepTheirLengths) {
  const HairMesh mesh = patch(Vec3(1, 0, 0));
  DynamicsSettings settings;
  settings.droop = 0;
  settings.drag = 6;
  settings.sleepSpeed = 0;
  auto simulation = Simulation::create(mesh, settings, centimetres());
  ASSERT_TRUE(simulation.ok());
  const auto positions = run(**simulation, 24 * 8);
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const HairVertex& vertex = mesh.vertices()[v];
    if (vertex.layer == 0) {
      EXPECT_EQ(positions[v], vertex.position);
      continue;
    }
    EXPECT_NEAR((positions[v] - positions[vertex.parent]).norm(), 1, 1e-9);
    // Hanging straight below its root; e^(−drag t / 2) of the swing is left after 8 s: 4e-11.
    EXPECT_NEAR(positions[v][1], -double(vertex.layer), 1e-6);
  }
  EXPECT_LE((*simulation)->report().maxStretch, 1e-9);
  EXPECT_EQ((*simulation)->report().resets, 0u);
}

// In a head turned slowly without gravity, air or anything else the style turns with it.
TEST(Simulation, AStiffStyleTurnsWithTheHead) {
  const HairMesh mesh = patch(Vec3(0.3, 1, 0.2));
  DynamicsSettings settings;
  settings.gravity = 0;
  settings.droop = 1e-9;
  settings.drag = 0;
  SimulationWorld world = centimetres();
  for (int f = 0; f <= 48; ++f) {
    world.motion.poses.push_back({about(Vec3(1, 2, 0.5), 0.5 * f / 48), Vec3(0.02 * f, 0.01 * f, 0)});
  }
  auto simulation = Simulation::create(mesh, settings, world);
  ASSERT_TRUE(simulation.ok());
  const auto positions = run(**simulation, 48);
  const RigidPose pose = world.motion.poses.back();
  // Stiff, not rigid: bending of a joint is of the order of droop.
  for (std::size_t v = 0; v < positions.size(); ++v)
    EXPECT_LE((positions[v] - pose.world(mesh.vertices()[v].position)).norm(), 1e-6);
  EXPECT_LE(((*simulation)->pose().rotation - pose.rotation).norm(), 1e-12);
}

TEST(Simulation, RootVerticesThatMoveRigidlyDoAsTheHeadDoes) {
  const HairMesh mesh = patch(Vec3(0.3, -1, 0.2));
  SimulationWorld byPose = centimetres(), byRoots = centimetres();
  for (int f = 0; f <= 12; ++f) {
    const RigidPose pose{about(Vec3(0, 1, 0), 0.002 * f), Vec3(0.1 * f, 0, 0)};
    byPose.motion.poses.push_back(pose);
    std::vector<Vec3> roots;
    for (const HairVertex& vertex : mesh.vertices())
      if (vertex.layer == 0) roots.push_back(pose.world(vertex.position));
    byRoots.motion.roots.push_back(roots);
  }
  auto a = Simulation::create(mesh, {}, byPose), b = Simulation::create(mesh, {}, byRoots);
  ASSERT_TRUE(a.ok() && b.ok());
  const auto left = run(**a, 12), right = run(**b, 12);
  // Between frames one goes round and the other straight: the sagitta of 0.002 rad over 4 units, 2e-6.
  for (std::size_t v = 0; v < left.size(); ++v) EXPECT_LE((left[v] - right[v]).norm(), 1e-5);
}

// In wind w a limp column with drag c comes to rest straight, along (c w, −g): drag and weight are both
// proportional to mass. Steady wind, gusts of no strength and a fluid that nothing stands in blow alike.
TEST(Simulation, LimpColumnsHangAlongTheSumOfWindAndWeight) {
  const HairMesh mesh = patch(Vec3(0, -1, 0));
  DynamicsSettings settings;
  settings.droop = 0;
  settings.drag = 6;
  settings.sleepSpeed = 0;
  settings.windVelocity = Vec3(0.8, 0, -0.3);
  settings.gustSpeed = 0;
  settings.shelter = 0;
  settings.airCells = 8;
  const Vec3 along = Vec3(6 * 0.8, -9.81, -6 * 0.3).normalized();
  for (const WindKind kind : {WindKind::Constant, WindKind::Gusts, WindKind::Fluid}) {
    settings.wind = kind;
    auto simulation = Simulation::create(mesh, settings, centimetres());
    ASSERT_TRUE(simulation.ok()) << simulation.error().text();
    const auto positions = run(**simulation, 24 * 8);
    for (std::size_t v = 0; v < positions.size(); ++v) {
      const HairVertex& vertex = mesh.vertices()[v];
      if (vertex.layer == 0) continue;
      // e^(−drag t / 2) of the swing is left after 8 s: 4e-11; uniform fluids stay so to 1e-13.
      EXPECT_LE((positions[v] - positions[vertex.parent] - along).norm(), 1e-6) << int(kind) << " " << v;
    }
  }
}

// A scalp that stretches and shears: roots where they are asked to be on every frame, links as long as ever.
TEST(Simulation, ADeformingScalpTakesItsRootsAlong) {
  const HairMesh mesh = patch(Vec3(0.3, -1, 0.2));
  SimulationWorld world = centimetres();
  for (int f = 0; f <= 12; ++f) {
    std::vector<Vec3> roots;
    for (const HairVertex& vertex : mesh.vertices()) {
      const Vec3& p = vertex.position;
      if (vertex.layer == 0)
        roots.emplace_back(p.x() * (1 + 0.02 * f) + 0.01 * f * p.z(), 0.02 * f * p.x() * p.z(), p.z());
    }
    world.motion.roots.push_back(roots);
  }
  auto simulation = Simulation::create(mesh, {}, world);
  ASSERT_TRUE(simulation.ok());
  for (int f = 1; f <= 12; ++f) {
    ASSERT_TRUE((*simulation)->advance().ok());
    for (std::size_t v = 0, root = 0; v < mesh.vertices().size(); ++v) {
      if (mesh.vertices()[v].layer == 0) {
        EXPECT_EQ((*simulation)->positions()[v], world.motion.roots[f][root++]);
      }
    }
  }
  EXPECT_LE((*simulation)->report().maxStretch, 1e-9);
  EXPECT_EQ((*simulation)->report().resets, 0u);
}

// Where the mesh splits, columns are trees, and hang as such.
TEST(Simulation, SplitColumnsAreTreesAndKeepTheirLengths) {
  HairMesh mesh = patch(Vec3(1, 0, 0), 3);
  for (const HairVertex& vertex : mesh.vertices())
    if (vertex.layer == 2 && separateVertex(mesh, vertex.id).ok()) break;
  DynamicsSettings settings;
  settings.droop = 0;
  settings.drag = 6;
  settings.sleepSpeed = 0;
  auto simulation = Simulation::create(mesh, settings, centimetres());
  ASSERT_TRUE(simulation.ok());
  EXPECT_GT((*simulation)->report().links,
            3 * (*simulation)->report().chains);  // more than plain columns have
  const auto positions = run(**simulation, 24 * 8);
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const HairVertex& vertex = mesh.vertices()[v];
    if (vertex.layer > 0) {
      EXPECT_NEAR(positions[v][1], -double(vertex.layer), 1e-6);
    }  // as above
  }
}

DynamicsSettings everything() {
  DynamicsSettings settings;
  settings.wind = WindKind::Fluid;
  settings.windVelocity = Vec3(1, 0, 0.5);
  settings.airCells = 8;
  settings.repulsion = 0.5;
  settings.density = 0.5;
  settings.hairFriction = 2;
  settings.lateral = 10;
  settings.capsules.push_back({Vec3(1, -2, 1), Vec3(2, -2, 1), 0.6, true});
  return settings;
}

SimulationWorld nodding() {
  SimulationWorld world = centimetres();
  for (int f = 0; f <= 10; ++f)
    world.motion.poses.push_back({about(Vec3(1, 0, 0), 0.1 * std::sin(0.7 * f)), Vec3::Zero()});
  return world;
}

TEST(Simulation, GoesOnWithTheSameBytesAfterAnInterruptionAndOnAnyNumberOfThreads) {
  const HairMesh mesh = patch(Vec3(0.4, -1, 0));
  Context one, two;
  one.threads = 1;
  two.threads = 2;
  auto whole = Simulation::create(mesh, everything(), nodding(), one);
  ASSERT_TRUE(whole.ok()) << whole.error().text();
  run(**whole, 10, one);
  auto first = Simulation::create(mesh, everything(), nodding(), two);
  run(**first, 4, two);
  const auto saved = (*first)->state();
  auto second = Simulation::create(mesh, everything(), nodding(), two);
  ASSERT_TRUE((*second)->restore(saved).ok());
  EXPECT_EQ((*second)->frame(), 4u);
  run(**second, 6, two);
  EXPECT_EQ((*whole)->state(), (*second)->state());
  EXPECT_EQ((*whole)->report().resets, 0u);
  // Contact has kinks that Newton may circle: below 2 % of the 16 chains × 50 steps.
  EXPECT_LE((*whole)->report().unconverged, 16u);
  for (const FieldUse& use : (*whole)->report().fields) EXPECT_GT(use.steps, 0u) << use.name;
}

TEST(Simulation, AHeadThatWasMeasuredIsNotMeasuredAgain) {
  const Surface head(makeExampleHead(16));
  SimulationWorld world = centimetres();
  world.head = &head;
  const HairMesh mesh = patch(Vec3(0.4, -1, 0));
  auto first = Simulation::create(mesh, {}, world);
  ASSERT_TRUE(first.ok()) << first.error().text();
  ASSERT_NE((*first)->band(), nullptr);
  world.band = (*first)->band();
  auto second = Simulation::create(mesh, {}, world);
  EXPECT_EQ((*second)->band(), (*first)->band());
  run(**first, 4);
  run(**second, 4);
  EXPECT_EQ((*first)->state(), (*second)->state());
}

TEST(Simulation, ACancelledFrameLeavesTheLastOne) {
  const HairMesh mesh = patch(Vec3(1, 0, 0));
  auto simulation = Simulation::create(mesh, {}, centimetres());
  run(**simulation, 2);
  const auto before = (*simulation)->state();
  std::atomic<bool> cancel = true;
  Context context;
  context.cancel = &cancel;
  const Status stopped = (*simulation)->advance(context);
  ASSERT_FALSE(stopped.ok());
  EXPECT_EQ(stopped.error().code, ErrorCode::Cancelled);
  EXPECT_EQ((*simulation)->state(), before);
}

TEST(Simulation, RefusesBadInputWithASentence) {
  const HairMesh mesh = patch(Vec3(0, -1, 0));
  DynamicsSettings settings;
  settings.drag = std::nan("");
  EXPECT_FALSE(Simulation::create(mesh, settings, centimetres()).ok());
  settings = {};
  settings.capsules.push_back({});
  EXPECT_FALSE(Simulation::create(mesh, settings, centimetres()).ok());
  EXPECT_FALSE(Simulation::create(mesh, {}, centimetres(0)).ok());
  EXPECT_FALSE(Simulation::create(mesh, {}, centimetres(std::nan(""))).ok());
  EXPECT_FALSE(Simulation::create(HairMesh(), {}, centimetres()).ok());
  SimulationWorld world = centimetres();
  world.motion.poses.push_back({2 * Mat3::Identity(), Vec3::Zero()});
  EXPECT_FALSE(Simulation::create(mesh, {}, world).ok());
  world.motion.poses.clear();
  world.motion.roots.push_back({Vec3::Zero()});
  EXPECT_FALSE(Simulation::create(mesh, {}, world).ok());
  auto fine = Simulation::create(mesh, {}, centimetres());
  ASSERT_TRUE(fine.ok());
  auto state = (*fine)->state();
  state.pop_back();
  EXPECT_FALSE((*fine)->restore(state).ok());
  EXPECT_FALSE((*fine)->restore(std::vector<std::byte>(7)).ok());
}

TEST(Drape, HangsAndIsUndoneExactly) {
  HairMesh mesh = patch(Vec3(1, 0.2, 0));
  const auto before = canonicalBytes(mesh);
  History history;
  DynamicsSettings settings;
  settings.droop = 0;
  settings.capsules.push_back(
      {Vec3(4, -1, -5), Vec3(4, -1, 8), 0.5, true});  // a rail across the patch's side
  settings.friction = 0;
  const auto report =
      history.apply(mesh, "drape", [&](HairMesh& m) { return drape(m, settings, centimetres()); });
  ASSERT_TRUE(report.ok()) << report.error().text();
  EXPECT_TRUE(report->settled);
  EXPECT_LE(report->lastMove, 1e-4 * 8);
  for (const HairVertex& vertex : mesh.vertices()) {
    if (vertex.layer == 0) continue;
    EXPECT_NEAR((vertex.position - mesh.position(vertex.parent)).norm(), std::sqrt(1.04), 1e-9);
    // Nothing is inside the rail by more than a weight's balance: a column's weight over a node, g k⁻¹ · 4.
    const Vec3 off(vertex.position[0] - 4, vertex.position[1] + 1, 0);
    EXPECT_GE(off.norm(), 0.5 + 0.4 - 0.05);
  }
  EXPECT_LT(mesh.vertices().back().position[1], -1);  // it hangs
  ASSERT_TRUE(history.undo(mesh).ok());
  EXPECT_EQ(canonicalBytes(mesh), before);
}

}  // namespace
}  // namespace coif
