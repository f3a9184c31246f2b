// Gravity, drag, gusts and the coarse fluid against answers.
#include "coif/simulate/forces.h"

#include <cmath>

#include "simulate/field_helpers.h"

namespace coif {
namespace {

using simulatetest::forceOf;
using simulatetest::Nodes;

Nodes oneNode(double mass = 2) {
  return {{Vec3(0.1, 0.2, 0.3)}, {Vec3::Zero()}, {mass}, {0.0}};
}

/// Implicit Euler by Newton on one free node, as a solver would use the fields.
void implicitStep(Nodes& nodes, std::span<ForceField* const> fields, double time, double h) {
  for (ForceField* field : fields) field->prepare(nodes.view(), time, h, {});
  for (std::uint32_t i = 0; i < nodes.positions.size(); ++i) {
    const Vec3 start = nodes.positions[i];
    Vec3 x = start + h * nodes.velocities[i];
    for (int newton = 0; newton < 50; ++newton) {
      const Vec3 v = (x - start) / h;
      Vec3 force = nodes.masses[i] / h * (nodes.velocities[i] - v);
      Mat3 stiffness = nodes.masses[i] / (h * h) * Mat3::Identity();
      for (const ForceField* field : fields)
        if (field->active()) field->add(i, x, v, force, stiffness);
      const Vec3 step = stiffness.inverse() * force;
      x += step;
      if (step.norm() < 1e-15) break;
    }
    nodes.velocities[i] = (x - start) / h;
    nodes.positions[i] = x;
  }
}

// m g = m (c₁ v + c₂ v²): the fixed point of the implicit step too, so only Newton's rounding remains.
TEST(Drag, ReachesTheTerminalVelocity) {
  for (const auto& [linear, quadratic] : {std::pair(3.0, 0.0), std::pair(0.0, 0.7), std::pair(2.0, 0.5)}) {
    Nodes nodes = oneNode();
    GravityField gravity(Vec3(0, -9.81, 0));
    DragField drag({linear, quadratic});
    ForceField* fields[] = {&gravity, &drag};
    for (int step = 0; step < 2000; ++step) implicitStep(nodes, fields, 0, 0.01);
    const double expected =
        quadratic > 0 ? (std::sqrt(linear * linear + 4 * quadratic * 9.81) - linear) / (2 * quadratic)
                      : 9.81 / linear;
    EXPECT_NEAR(nodes.velocities[0][1], -expected, 1e-9 * expected);
  }
}

TEST(Drag, TakesTheWindsVelocityAndNothingElse) {
  const Vec3 wind(3, -1, 2);
  ConstantWind air(wind);
  Nodes nodes = oneNode();
  DragField drag({5, 0}, &air);
  ForceField* fields[] = {&drag};
  for (int step = 0; step < 1000; ++step) implicitStep(nodes, fields, 0, 0.02);
  // The difference shrinks by 1.1 a step: 1.1^-1000 is nothing beside the rounding of positions, which are
  // below 100 and are divided by the step: 100 · 1e-16 / 0.02 and some of these.
  EXPECT_LE((nodes.velocities[0] - wind).norm(), 1e-11);
}

// f is a polynomial of v (times |w|, smooth away from w = 0): differences of step 1e-6 are good to 1e-8.
TEST(Drag, StiffnessIsTheDerivativeByVelocityOverTheStep) {
  Nodes nodes = oneNode();
  const double h = 0.02;
  DragField drag({1.5, 0.8});
  drag.prepare(nodes.view(), 0, h, {});
  const Vec3 v(0.3, -2, 1);
  Mat3 stiffness;
  forceOf(drag, 0, nodes.positions[0], v, &stiffness);
  simulatetest::expectPositiveSemidefinite(stiffness);
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 by = 1e-6 * Vec3::Unit(axis);
    const Vec3 slope = (forceOf(drag, 0, {}, v - by) - forceOf(drag, 0, {}, v + by)) / 2e-6;
    EXPECT_LE((slope / h - stiffness.col(axis)).norm(), 1e-7 * stiffness.norm());
  }
}

TEST(Drag, IsInactiveWithoutARateAndSaysSo) {
  EXPECT_FALSE(DragField({}).active());
  EXPECT_STRNE(DragField({}).idleReason(), "");
  EXPECT_TRUE(DragField({1, 0}).active());
  EXPECT_FALSE(GravityField(Vec3::Zero()).active());
}

TEST(Gravity, ForceIsMinusTheGradientOfItsEnergy) {
  Nodes nodes = oneNode();
  GravityField gravity(Vec3(1, -9.81, 0.5));
  gravity.prepare(nodes.view(), 0, 0.01, {});
  // Linear: differences have rounding alone.
  EXPECT_LE((simulatetest::differences(gravity, 0, nodes.positions[0], 0.1) -
             forceOf(gravity, 0, nodes.positions[0], {}))
                .norm(),
            1e-13);
}

TEST(GustyWind, HasNoDivergence) {
  GustyWind wind({Vec3(1, 0, 0), 3, 0.5, 2, 7});
  const CounterRandom random(3);
  const double step = 1e-5;
  double worst = 0, scale = 0;
  for (std::uint64_t i = 0; i < 300; ++i) {
    Vec3 at;
    for (int axis = 0; axis < 3; ++axis) at[axis] = 20 * random.uniform(4 * i + std::uint64_t(axis)) - 10;
    const double time = 5 * random.uniform(4 * i + 3);
    double divergence = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 by = step * Vec3::Unit(axis);
      const Vec3 slope = (wind.velocityAt(at + by, time) - wind.velocityAt(at - by, time)) / (2 * step);
      divergence += slope[axis];
      scale = std::max(scale, slope.norm());
    }
    worst = std::max(worst, std::abs(divergence));
  }
  EXPECT_GT(scale, 1);  // it does vary
  // Second derivatives have kinks between cells, where a difference across is good to its step.
  EXPECT_LE(worst, 100 * step * scale);
}

TEST(GustyWind, HasTheSpeedAskedForAndTheMean) {
  GustyWind wind({Vec3(2, 0, -1), 3, 0.5, 2, 7});
  const CounterRandom random(3);
  double square = 0;
  Vec3 mean = Vec3::Zero();
  const int count = 40000;
  for (std::uint64_t i = 0; i < count; ++i) {
    Vec3 at;
    for (int axis = 0; axis < 3; ++axis) at[axis] = 200 * random.uniform(4 * i + std::uint64_t(axis)) - 100;
    const Vec3 v = wind.velocityAt(at, 9 * random.uniform(4 * i + 3));
    mean += v / count;
    square += (v - Vec3(2, 0, -1)).squaredNorm() / count;
  }
  // Statistical: 40 000 samples of a few hundred thousand cells; 3 / √40000 = 0.015 a component, four sigma.
  EXPECT_LE((mean - Vec3(2, 0, -1)).norm(), 0.06);
  EXPECT_NEAR(std::sqrt(square), 3, 0.06);
}

TEST(GustyWind, IsContinuousInTimeAndFiniteAnywhere) {
  GustyWind wind({Vec3::Zero(), 1, 1, 0.5, 1});
  const Vec3 at(0.3, 0.7, -0.2);
  // At a change of patterns, t = 0.5, the slope in time is at most π/2 / turnover · |u| ~ 10.
  EXPECT_LE((wind.velocityAt(at, 0.5 - 1e-9) - wind.velocityAt(at, 0.5 + 1e-9)).norm(), 1e-7);
  EXPECT_LE(
      (wind.velocityAt(Vec3(-1e-12, 0.5, 0.5), 0.1) - wind.velocityAt(Vec3(1e-12, 0.5, 0.5), 0.1)).norm(),
      1e-9);
  for (const double big : {1e12, 1e300, -1e300, std::nan(""), HUGE_VAL})
    EXPECT_TRUE(wind.velocityAt(Vec3(big, 0, 0), big).allFinite()) << big;
}

FluidOptions smallBox(const Vec3& mean) {
  FluidOptions options;
  options.mean = mean;
  options.cells = 16;
  options.tolerance = 1e-6;
  return options;
}

AirObstacle sphere(double radius, const Vec3& velocity = Vec3::Zero()) {
  return {[radius](const Vec3& p) { return p.norm() - radius; },
          [velocity](const Vec3&) { return velocity; }};
}

TEST(Fluid, StaysStillAndStaysUniform) {
  const Nodes nodes;
  for (const Vec3& mean : {Vec3(0, 0, 0), Vec3(1, 2, -0.5)}) {
    auto air = FluidWind::create(smallBox(mean));
    ASSERT_TRUE(air.ok());
    for (int step = 0; step < 5; ++step) (*air)->prepare(nodes.view(), 0, 0.05, {});
    // Interpolation of a constant: weights add to 1 but for rounding.
    for (const Vec3& at : {Vec3(0, 0, 0), Vec3(0.9, -0.9, 0.3), Vec3(5, 0, 0)})
      EXPECT_LE(((*air)->velocity(at) - mean).norm(), 1e-13);
  }
}

TEST(Fluid, FlowsAroundASphereWithoutDivergence) {
  const Nodes nodes;
  auto air = FluidWind::create(smallBox(Vec3(1, 0, 0)), sphere(0.4));
  ASSERT_TRUE(air.ok());
  for (int step = 0; step < 10; ++step) {
    (*air)->prepare(nodes.view(), 0, 0.05, {});
    EXPECT_LE((*air)->report().divergence, 1.01e-6);  // the tolerance, and rounding of the update
  }
  EXPECT_LE(std::abs((*air)->velocity(Vec3(-0.45, 0, 0))[0]), 0.5);  // stagnates in front
  // Potential flow has 1.5 times the free stream at the side, 1 + r³/2d³ = 1.18 at d = 0.56; a grid of 16
  // cells and the wake leave part of it.
  EXPECT_GT((*air)->velocity(Vec3(0, 0.56, 0))[0], 1.05);
}

TEST(Fluid, AMovingHeadDrivesStillAir) {
  const Nodes nodes;
  auto air = FluidWind::create(smallBox(Vec3::Zero()), sphere(0.4, Vec3(0, 0, 2)));
  ASSERT_TRUE(air.ok());
  (*air)->prepare(nodes.view(), 0, 0.05, {});
  EXPECT_GT((*air)->velocity(Vec3(0, 0, 0.5))[2], 0.5);  // pushed ahead
  EXPECT_LT((*air)->velocity(Vec3(0.6, 0, 0))[2], 0);    // and back around it
}

TEST(Fluid, HairSlowsTheWind) {
  Nodes nodes = Nodes::cloud(4000, 0.5, 0);
  FluidOptions options = smallBox(Vec3(1, 0, 0));
  auto free = FluidWind::create(options);
  options.hairDrag = 0.01;  // 4000 nodes of mass 1 in 1/8 of volume: a rate of about 300
  auto porous = FluidWind::create(options);
  ASSERT_TRUE(free.ok() && porous.ok());
  for (int step = 0; step < 10; ++step) {
    (*free)->prepare(nodes.view(), 0, 0.05, {});
    (*porous)->prepare(nodes.view(), 0, 0.05, {});
  }
  EXPECT_NEAR((*free)->velocity(Vec3::Zero())[0], 1, 1e-9);
  EXPECT_LT((*porous)->velocity(Vec3::Zero())[0], 0.3);
  EXPECT_GT((*porous)->velocity(Vec3(0, 0.6, 0))[0], 1);  // it goes around
}

TEST(Fluid, HasTheSameBytesForAnyNumberOfThreadsAndResumes) {
  const Nodes nodes = Nodes::cloud(500, 1.5, 1);
  FluidOptions options = smallBox(Vec3(1, 0.5, 0));
  options.hairDrag = 0.01;
  std::vector<double> states[3];
  for (int run = 0; run < 3; ++run) {
    auto air = FluidWind::create(options, sphere(0.3));
    Context context;
    context.threads = run == 1 ? 2 : 1;
    for (int step = 0; step < 6; ++step) {
      if (run == 2 && step == 3) {
        auto fresh = FluidWind::create(options, sphere(0.3));
        ASSERT_TRUE((*fresh)->restore((*air)->state()).ok());
        *air = std::move(*fresh);
      }
      (*air)->prepare(nodes.view(), 0, 0.04, context);
    }
    states[run] = (*air)->state();
  }
  EXPECT_EQ(states[0], states[1]);
  EXPECT_EQ(states[0], states[2]);
}

TEST(Fluid, RefusesBadOptionsAndSurvivesBadNodes) {
  FluidOptions options = smallBox(Vec3::Zero());
  options.hi = options.lo;
  EXPECT_FALSE(FluidWind::create(options).ok());
  options = smallBox(Vec3(std::nan(""), 0, 0));
  EXPECT_FALSE(FluidWind::create(options).ok());
  options = smallBox(Vec3(1, 0, 0));
  options.cells = 1000;
  EXPECT_FALSE(FluidWind::create(options).ok());
  options.cells = 8;
  options.hairDrag = 1;
  auto air = FluidWind::create(options);
  Nodes nodes = Nodes::cloud(20, 1, 1);
  nodes.positions[3][1] = std::nan("");
  nodes.velocities[4][0] = HUGE_VAL;
  nodes.velocities[5][0] = 1e200;
  for (int step = 0; step < 3; ++step) (*air)->prepare(nodes.view(), 0, 0.05, {});
  for (const double u : (*air)->state()) ASSERT_TRUE(std::isfinite(u));
  EXPECT_FALSE((*air)->restore(std::vector<double>(3)).ok());
}

}  // namespace
}  // namespace coif
