// Repulsion against its energy written out in double, and the splat it stands on.
#include "coif/simulate/repulsion.h"

#include <cmath>

#include "simulate/field_helpers.h"

namespace coif {
namespace {

using simulatetest::forceOf;
using simulatetest::Nodes;

/// E = ½ k V Σ max(ρ − ρ0, 0)² of all nodes, in double, on the field's own frame.
double bruteEnergy(const GridFrame& frame, const Nodes& nodes, const RepulsionOptions& options) {
  const auto n = std::size_t(frame.size());
  const double volume = std::pow(frame.cell, 3);
  std::vector<double> density(n * n * n, 0);
  for (std::size_t i = 0; i < nodes.positions.size(); ++i) {
    SplatStencil(frame.cellsFromWorld(nodes.positions[i]))
        .forEach([&](long x, long y, long z, double w, const Vec3&) {
          density[frame.index(x, y, z)] += nodes.masses[i] * w / volume;
        });
  }
  double sum = 0;
  for (const double rho : density) sum += std::pow(std::max(0.0, rho - options.restDensity), 2);
  return 0.5 * options.stiffness * volume * sum;
}

TEST(Splat, WeightsAddToOneAndReproduceLinearFunctions) {
  const CounterRandom random(1);
  for (std::uint64_t i = 0; i < 50; ++i) {
    const Vec3 at(9 * random.uniform(3 * i), 9 * random.uniform(3 * i + 1), 9 * random.uniform(3 * i + 2));
    double sum = 0;
    Vec3 slopes = Vec3::Zero(), centre = Vec3::Zero();
    SplatStencil(at).forEach([&](long x, long y, long z, double w, const Vec3& g) {
      sum += w;
      slopes += g;
      centre += w * Vec3(double(x) + 0.5, double(y) + 0.5, double(z) + 0.5);
    });
    // Sums of 27 numbers below 10: rounding.
    EXPECT_NEAR(sum, 1, 1e-14);
    EXPECT_LE(slopes.norm(), 1e-14);
    EXPECT_LE((centre - at).norm(), 1e-13);
  }
}

TEST(Splat, KeepsMassAndHasTheSameBytesForAnyNumberOfThreads) {
  const Nodes nodes = Nodes::cloud(3000, 2, 1);
  const GridFrame frame = frameAround(Vec3::Constant(-1), Vec3::Constant(1), 0.1);
  EXPECT_TRUE(frame.holds(Vec3::Constant(2)));
  PointSplatter splatter;
  std::vector<float> one, two;
  Context context;
  context.threads = 1;
  splatter.splat(frame, nodes.positions, nodes.masses, 1, one, context);
  context.threads = 2;
  splatter.splat(frame, nodes.positions, nodes.masses, 1, two, context);
  EXPECT_EQ(one, two);
  double sum = 0, mass = 0;
  for (const float value : one) sum += value;
  for (const double m : nodes.masses) mass += m;
  EXPECT_NEAR(sum, mass, 1e-6 * mass);  // floats, rounded 27 times a node with both signs
}

TEST(Repulsion, ForceIsMinusTheGradientOfTheEnergyOfAllNodes) {
  Nodes nodes = Nodes::cloud(200, 1, 0);
  RepulsionOptions options{2.5, 150, 0.13};
  RepulsionField field(options);
  field.prepare(nodes.view(), 0, 0.01, {});
  ASSERT_TRUE(field.active());
  const double energy = bruteEnergy(field.frame(), nodes, options);
  EXPECT_NEAR(field.totalEnergy(), energy, 1e-5 * energy);  // the field's densities are floats
  double largest = 0;
  for (std::uint32_t i = 0; i < 200; ++i)
    largest = std::max(largest, forceOf(field, i, nodes.positions[i], nodes.velocities[i]).norm());
  ASSERT_GT(largest, 0);
  for (std::uint32_t i = 0; i < 200; i += 7) {
    const Vec3 force = forceOf(field, i, nodes.positions[i], nodes.velocities[i]);
    for (int axis = 0; axis < 3; ++axis) {
      const double step = 1e-5;
      Nodes moved = nodes;
      moved.positions[i][axis] += step;
      const double above = bruteEnergy(field.frame(), moved, options);
      moved.positions[i][axis] -= 2 * step;
      const double below = bruteEnergy(field.frame(), moved, options);
      // Float densities (1e-7 of ρ, here of the same size as ρ − ρ0) and the difference's step² / cell².
      EXPECT_NEAR(force[axis], (below - above) / (2 * step), 1e-5 * largest) << i << " " << axis;
    }
  }
}

TEST(Repulsion, WithinTheStepForceEnergyAndStiffnessAgree) {
  Nodes nodes = Nodes::cloud(200, 1, 2);
  RepulsionField field({2.5, 100, 0.13, 6, 3});
  field.prepare(nodes.view(), 0, 0.01, {});
  for (std::uint32_t i = 0; i < 200; i += 11) {
    const Vec3 at = nodes.positions[i] + Vec3(0.02, -0.01, 0.03);
    Mat3 stiffness;
    forceOf(field, i, at, nodes.velocities[i], &stiffness);
    simulatetest::expectPositiveSemidefinite(stiffness);
    // A quadratic in x, but for the friction, which does not depend on it: rounding alone.
    const Vec3 atRest = forceOf(field, i, at, nodes.velocities[i]) -
                        forceOf(field, i, nodes.positions[i], nodes.velocities[i]);
    const Vec3 slope = simulatetest::differences(field, i, at, 0.01) -
                       simulatetest::differences(field, i, nodes.positions[i], 0.01);
    EXPECT_LE((atRest - slope).norm(), 1e-9 * (1 + slope.norm()));
  }
}

/// Moving as one costs nothing: the force where the cloud carries a node is that of the start.
TEST(Repulsion, DoesNotHoldBackHairThatMovesAsOne) {
  Nodes nodes = Nodes::cloud(200, 1, 0);
  RepulsionField still({2.5, 100, 0.13});
  still.prepare(nodes.view(), 0, 0.01, {});
  const Vec3 velocity(30, -20, 10);
  for (Vec3& v : nodes.velocities) v = velocity;
  RepulsionField moving({2.5, 100, 0.13});
  moving.prepare(nodes.view(), 0, 0.01, {});
  for (std::uint32_t i = 0; i < 200; ++i) {
    const Vec3 expected = forceOf(still, i, nodes.positions[i], {});
    const Vec3 found = forceOf(moving, i, nodes.positions[i] + 0.01 * velocity, velocity);
    // The mean velocity is a quotient of float sums: 1e-6 of 0.4 travelled, times stiffness.
    Mat3 k;
    forceOf(still, i, nodes.positions[i], {}, &k);
    EXPECT_LE((found - expected).norm(), 1e-6 * (expected.norm() + k.norm())) << i;
  }
}

/// The whole point: implicit steps of nodes taken one by one lower the energy even when it is very stiff.
TEST(Repulsion, NodesSolvedOneByOneDoNotOvershoot) {
  for (const double stiffness : {1e-2, 1.0, 1e4}) {
    Nodes nodes = Nodes::cloud(400, 0.5, 0);
    RepulsionField field({stiffness, 500, 0.1});
    double last = HUGE_VAL;
    for (int step = 0; step < 30; ++step) {
      const double h = 0.02;
      field.prepare(nodes.view(), 0, h, {});
      if (!field.active()) break;
      EXPECT_LE(field.totalEnergy(), 1.02 * last) << stiffness << " " << step;  // the grid moves with the box
      last = field.totalEnergy();
      for (std::uint32_t i = 0; i < 400; ++i) {
        Mat3 matrix;
        const Vec3 force = forceOf(field, i, nodes.positions[i], Vec3::Zero(), &matrix);
        matrix += nodes.masses[i] / (h * h) * Mat3::Identity();
        nodes.positions[i] += matrix.inverse() * force;  // from rest: velocities stay zero
      }
    }
    EXPECT_TRUE(std::isfinite(last));
  }
}

TEST(Repulsion, IsLeftOutWhereThereIsNothingToPushAndSaysWhy) {
  const Nodes nodes = Nodes::cloud(50, 1, 1);
  RepulsionField off({0, 1, 0.1});
  off.prepare(nodes.view(), 0, 0.01, {});
  EXPECT_FALSE(off.active());
  EXPECT_STREQ(off.idleReason(), "repulsion is off");
  RepulsionField loose({1, 1e9, 0.1});
  loose.prepare(nodes.view(), 0, 0.01, {});
  EXPECT_FALSE(loose.active());
  EXPECT_STRNE(loose.idleReason(), off.idleReason());
}

TEST(Repulsion, SurvivesNodesThatAreNotFiniteAndHugeBoxes) {
  Nodes nodes = Nodes::cloud(50, 1, 1);
  nodes.positions[0][0] = std::nan("");
  nodes.positions[1][0] = HUGE_VAL;
  nodes.positions[2] = Vec3::Constant(1e12);
  nodes.velocities[3][0] = std::nan("");
  RepulsionField field({1, 0, 0.01});
  field.prepare(nodes.view(), 0, 0.01, {});
  for (std::uint32_t i = 0; i < 50; ++i) {
    EXPECT_TRUE(forceOf(field, i, nodes.positions[4], nodes.velocities[4]).allFinite()) << i;
  }
}

}  // namespace
}  // namespace coif
