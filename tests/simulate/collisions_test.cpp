// Spheres, capsules and the head's distances; contact that holds, slides and is never passed through.
#include "coif/simulate/collisions.h"

#include <cmath>
#include <numbers>

#include "coif/scalp/example_head.h"
#include "coif/simulate/forces.h"
#include "simulate/field_helpers.h"

namespace coif {
namespace {

using simulatetest::forceOf;
using simulatetest::Nodes;

Nodes one(const Vec3& position, const Vec3& velocity = Vec3::Zero(), double radius = 0.01) {
  return {{position}, {velocity}, {2.0}, {radius}};
}

/// An implicit Euler step of free nodes by Newton with back-tracking on nothing: the fields are convex
/// enough.
void step(Nodes& nodes, CollisionField& field, const Vec3& gravity, double h) {
  field.prepare(nodes.view(), 0, h, {});
  for (std::uint32_t i = 0; i < nodes.positions.size(); ++i) {
    const Vec3 start = nodes.positions[i];
    const double mass = nodes.masses[i];
    Vec3 x = start + h * nodes.velocities[i];
    for (int newton = 0; newton < 100; ++newton) {
      const Vec3 v = (x - start) / h;
      Vec3 force = mass * gravity + mass / h * (nodes.velocities[i] - v);
      Mat3 stiffness = mass / (h * h) * Mat3::Identity();
      if (field.active()) field.add(i, x, v, force, stiffness);
      const Vec3 by = stiffness.inverse() * force;
      x += by;
      if (by.norm() < 1e-14) break;
    }
    nodes.velocities[i] = (x - start) / h;
    nodes.positions[i] = x;
  }
}

TEST(Collider, SpheresAndCapsulesHaveTheirTextbookDistances) {
  const SphereCollider sphere(Vec3(1, 0, 0), 0.5);
  const CapsuleCollider capsule(Vec3(0, 0, 0), Vec3(0, 2, 0), 0.25);
  double distance = 0;
  Vec3 normal;
  ASSERT_TRUE(sphere.sample(Vec3(1, 2, 0), distance, normal));
  EXPECT_DOUBLE_EQ(distance, 1.5);
  EXPECT_EQ(normal, Vec3(0, 1, 0));
  ASSERT_TRUE(capsule.sample(Vec3(1, 1, 0), distance, normal));
  EXPECT_DOUBLE_EQ(distance, 0.75);
  ASSERT_TRUE(capsule.sample(Vec3(0, 3, 0), distance, normal));
  EXPECT_DOUBLE_EQ(distance, 0.75);
  EXPECT_EQ(normal, Vec3(0, 1, 0));
  ASSERT_TRUE(sphere.sample(Vec3(1, 0, 0), distance, normal));  // its very centre
  EXPECT_DOUBLE_EQ(distance, -0.5);
  EXPECT_TRUE(normal.allFinite());
  EXPECT_FALSE(sphere.sample(Vec3(std::nan(""), 0, 0), distance, normal));
}

TEST(Collision, AWeightRestsAtTheDepthThatBalancesIt) {
  const SphereCollider sphere(Vec3::Zero(), 1);
  CollisionField field({1e4, 0.005});
  field.addCollider(sphere);
  Nodes nodes = one(Vec3(0, 1.2, 0));
  for (int i = 0; i < 400; ++i) step(nodes, field, Vec3(0, -9.81, 0), 0.01);
  // radius + band − g / stiffness; the implicit step's damping has long brought it to rest.
  EXPECT_NEAR(nodes.positions[0][1], 1 + 0.01 + 0.005 - 9.81 / 1e4, 1e-9);
}

TEST(Collision, ForceIsMinusTheGradientOfItsEnergyForEveryShape) {
  const SphereCollider sphere(Vec3::Zero(), 1);
  const CapsuleCollider capsule(Vec3(0, 0.6, 0), Vec3(0.5, 1.2, 0.4), 0.3);
  CollisionField field({50, 0.1});
  field.addCollider(sphere,
                    {Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix(), Vec3(0.1, 0, 0)});
  field.addCollider(capsule, {Eigen::AngleAxisd(0.2, Vec3::UnitX()).toRotationMatrix(), Vec3::Zero()});
  Nodes nodes = Nodes::cloud(200, 2.2, 0.1);
  field.prepare(nodes.view(), 0, 0.01, {});
  int touching = 0;
  for (std::uint32_t i = 0; i < 200; ++i) {
    const Vec3 at = nodes.positions[i];
    Mat3 stiffness;
    const Vec3 force = forceOf(field, i, at, nodes.velocities[i], &stiffness);
    simulatetest::expectPositiveSemidefinite(stiffness);
    touching += force.norm() > 0;
    // Third derivatives of the penalty are k depth / r² ~ 50 · 1 / 0.1² near centres; step² of that.
    EXPECT_LE((force - simulatetest::differences(field, i, at, 1e-6)).norm(), 1e-6 * (1 + force.norm())) << i;
  }
  EXPECT_GT(touching, 20);
}

TEST(Collision, AFastNodeDoesNotPassThroughAThinSolid) {
  const CapsuleCollider wall(Vec3(-5, 0, 0), Vec3(5, 0, 0), 0.01);
  for (const double speed : {1.0, 10.0, 1000.0, 1e6}) {
    for (const double h : {1.0 / 240, 1.0 / 24}) {
      CollisionField field({1e6, 0});
      field.addCollider(wall);
      Nodes nodes = one(Vec3(0.3, 0.02 + 0.5 * speed * h, 0), Vec3(0, -speed, 0));
      if (speed * h < 0.04) nodes.positions[0][1] = 0.021;
      step(nodes, field, Vec3::Zero(), h);
      EXPECT_EQ(field.sweptCount(), speed * h > 0.5 * 0.01 ? 1u : 0u);
      // Held at the surface but for the depth that the momentum of this step compresses: v h / (1 + k h²).
      EXPECT_GE(nodes.positions[0][1], 0.02 - speed * h / (1 + 1e6 * h * h) - 1e-9) << speed;
    }
  }
}

TEST(Collision, AMovingSolidTakesANodeAlong) {
  const SphereCollider sphere(Vec3::Zero(), 0.05);
  CollisionField field({1e6, 0});
  const std::size_t index = field.addCollider(sphere);
  Nodes nodes = one(Vec3(0.2, 0, 0));
  const double h = 1.0 / 60;
  for (int i = 0; i < 30; ++i) {  // 0.2 a step: twice the sphere's width
    field.setMotion(index, {Mat3::Identity(), Vec3(0.2 * i, 0, 0)},
                    {Mat3::Identity(), Vec3(0.2 * (i + 1), 0, 0)});
    step(nodes, field, Vec3::Zero(), h);
    EXPECT_GE(nodes.positions[0][0], 0.2 * (i + 1) + 0.05) << i;  // ahead of it, out of it
  }
}

// On a slope of angle θ a weight rests where μ > tan θ (creeping with the slip speed at most) and slides with
// g (sin θ − μ cos θ) where it is less.
TEST(Collision, FrictionHoldsBelowItsAngleAndSlidesAboveByCoulombsLaw) {
  const SphereCollider ground(Vec3(0, -1e4, 0), 1e4);  // flat: 1e4 wide
  const double angle = 0.4, h = 0.002;
  const Vec3 gravity(9.81 * std::sin(angle), -9.81 * std::cos(angle), 0);
  for (const double friction : {0.6, 0.2}) {
    CollisionOptions options{1e5, 0, friction, 1e-3, 0};
    CollisionField field(options);
    field.addCollider(ground);
    Nodes nodes = one(Vec3(0, 0.01 - 9.81 * std::cos(angle) / 1e5, 0));
    const int steps = 500;
    for (int i = 0; i < steps; ++i) step(nodes, field, gravity, h);
    if (friction > std::tan(angle)) {
      EXPECT_LE(std::abs(nodes.velocities[0][0]), 1e-3);
    } else {
      const double expected = steps * h * 9.81 * (std::sin(angle) - friction * std::cos(angle));
      // The first steps, below the slip speed, and the lag of one step: 1 %.
      EXPECT_NEAR(nodes.velocities[0][0], expected, 0.01 * expected);
    }
  }
}

TEST(Collision, LooksAtNothingFarAwayAndSaysSo) {
  const SphereCollider sphere(Vec3::Zero(), 1);
  CollisionField empty(CollisionOptions{});
  const Nodes far = one(Vec3(0, 5, 0), Vec3(0, 1, 0));
  empty.prepare(far.view(), 0, 0.01, {});
  EXPECT_FALSE(empty.active());
  CollisionField field(CollisionOptions{});
  field.addCollider(sphere);
  field.prepare(far.view(), 0, 0.01, {});
  EXPECT_FALSE(field.active());
  EXPECT_STRNE(field.idleReason(), empty.idleReason());
  Nodes near = one(Vec3(0, 1.005, 0));
  field.prepare(near.view(), 0, 0.01, {});
  EXPECT_TRUE(field.active());
  field.exempt({1});
  field.prepare(near.view(), 0, 0.01, {});
  EXPECT_FALSE(field.active());
}

TEST(Collision, SurvivesNodesThatAreNotFinite) {
  const SphereCollider sphere(Vec3::Zero(), 1);
  CollisionField field({1e4, 0.1, 0.5, 1e-3, 1});
  field.addCollider(sphere);
  for (const double bad : {std::nan(""), HUGE_VAL, 1e308, -1e308}) {
    Nodes nodes = one(Vec3(bad, 0.5, 0), Vec3(0, bad, 0));
    nodes.positions.push_back(Vec3(0, 0.9, 0));
    nodes.velocities.push_back(Vec3::Zero());
    nodes.masses.push_back(1);
    nodes.radii.push_back(0.01);
    field.prepare(nodes.view(), 0, 0.01, {});
    EXPECT_TRUE(forceOf(field, 1, nodes.positions[1], nodes.velocities[1]).allFinite());
    EXPECT_GT(forceOf(field, 1, nodes.positions[1], nodes.velocities[1])[1], 0);
  }
}

// A sphere of fine triangles: the band's distance against the analytic one.
TEST(DistanceBand, ConvergesOnTheExactDistances) {
  PolygonMesh mesh;
  const std::uint32_t rings = 64, sides = 128;
  for (std::uint32_t r = 0; r <= rings; ++r) {
    for (std::uint32_t s = 0; s < sides; ++s) {
      const double a = std::numbers::pi * r / rings, b = 2 * std::numbers::pi * s / sides;
      mesh.positions.push_back(Vec3(std::sin(a) * std::cos(b), std::cos(a), -std::sin(a) * std::sin(b)));
    }
  }
  for (std::uint32_t r = 0; r < rings; ++r) {
    for (std::uint32_t s = 0; s < sides; ++s) {
      const std::uint32_t t = (s + 1) % sides;
      if (r + 1 < rings) mesh.addFace(std::array{r * sides + s, (r + 1) * sides + s, (r + 1) * sides + t});
      if (r > 0) mesh.addFace(std::array{r * sides + s, (r + 1) * sides + t, r * sides + t});
    }
  }
  // Poles: each ring's end lies on one point; faces there share it geometrically.
  const Surface surface(mesh);
  double worst[2];
  for (int level = 0; level < 2; ++level) {
    auto band = DistanceBand::build(surface, {level == 0 ? 0.2 : 0.1, 0.3});
    ASSERT_TRUE(band.ok()) << band.error().text();
    worst[level] = 0;
    const CounterRandom random(4);
    for (std::uint64_t i = 0; i < 1000; ++i) {
      const double z = 2 * random.uniform(3 * i) - 1, phi = 6.28318 * random.uniform(3 * i + 1);
      const double radius = 0.85 + 0.4 * random.uniform(3 * i + 2);
      const double ring = std::sqrt(1 - z * z);
      const Vec3 out(ring * std::cos(phi), z, ring * std::sin(phi));
      double distance = 0;
      Vec3 normal;
      ASSERT_TRUE(band->sample(radius * out, distance, normal));
      worst[level] = std::max(worst[level], std::abs(distance - (radius - 1)));
      EXPECT_LE((normal - out).norm(), level == 0 ? 0.1 : 0.05);
    }
    double distance = 0;
    Vec3 normal;
    ASSERT_TRUE(band->sample(Vec3(0.3, 0.1, 0), distance, normal));  // deep inside: leads out
    EXPECT_LT(distance, -0.3);
    EXPECT_GT(normal.dot(Vec3(0.3, 0.1, 0)), 0);
    EXPECT_FALSE(band->sample(Vec3(3, 0, 0), distance, normal));
  }
  // The facets stand off the sphere by 1 − cos(π / 64) = 1.2e-3; beyond that, cell³ / 6 · |d‴| (~ 2 / r²).
  EXPECT_LE(worst[0], 1.2e-3 + 0.2 * 0.2 * 0.2 / 3);
  EXPECT_LE(worst[1], 1.2e-3 + 0.1 * 0.1 * 0.1 / 3);
}

TEST(DistanceBand, StatesItsErrorOnTheExampleHeadAndANodeDroppedEndsOutside) {
  const PolygonMesh head = makeExampleHead(32);
  const Surface surface(head);
  const double size = surface.size();
  auto band = DistanceBand::build(surface, {size / 64, 0});
  ASSERT_TRUE(band.ok()) << band.error().text();
  const DistanceBandReport& report = band->report();
  EXPECT_GT(report.bricks, 0u);
  // Measured: rms 0.018 and worst 0.15 of a cell, at the ears, whose edges the grid rounds.
  EXPECT_LE(report.rmsError, 0.03 * band->cell());
  EXPECT_LE(report.worstError, 0.3 * band->cell());

  CollisionField field({1e5, 0.002 * size});
  field.addCollider(*band);
  const Box box = bounds(head.positions);
  Nodes nodes =
      one(Vec3(0.5 * (box.lo[0] + box.hi[0]), box.hi[1] + 0.05 * size, 0.5 * (box.lo[2] + box.hi[2])),
          Vec3::Zero(), 0.002 * size);
  const double g = 10 * size;
  for (int i = 0; i < 100; ++i) step(nodes, field, Vec3(0, -g, 0), 0.01);
  // It lies on the crown (or has slid to the side of it), within radius + band of the surface, outside.
  const double distance = surface.signedDistance(nodes.positions[0]);
  EXPECT_GT(distance, 0);
  if (nodes.positions[0][1] > box.lo[1] + 0.8 * (box.hi[1] - box.lo[1])) {
    EXPECT_LT(distance, 0.004 * size + report.worstError);
  }
}

TEST(DistanceBand, RefusesWhatItCannotHold) {
  PolygonMesh empty;
  EXPECT_FALSE(DistanceBand::build(Surface{empty}).ok());
  const Surface head(makeExampleHead(16));
  EXPECT_FALSE(DistanceBand::build(head, {-1, 0}).ok());
  EXPECT_FALSE(DistanceBand::build(head, {1e-9 * head.size(), 0}).ok());
}

}  // namespace
}  // namespace coif
