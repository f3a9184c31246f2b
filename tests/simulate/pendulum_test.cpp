// Motion with known answers: pendulums, free fall, momentum, spin, the hanging chain's modes.
#include <functional>
#include <numbers>

#include "simulate/chain_samples.h"

namespace coif {
namespace {

constexpr double kG = 9.81;

// The order that a method promises; measured orders of the finest pair come within kOrderSlack of it where
// the next term of the error is still felt.
int orderOf(DynamicsMethod m) {
  return m == DynamicsMethod::DirectBdf2 || m == DynamicsMethod::EnergyKeeping ? 2 : 1;
}
constexpr double kOrderSlack = 0.15;

double periodOf(DynamicsMethod method, double amplitude, double h) {
  const ChainSet c = straightChain(1, 1, Vec3(std::sin(amplitude), -std::cos(amplitude), 0));
  const auto solver = samples::solverFor(c, method);
  ChainState state = restState(c);
  double before = state.positions[1].x(), crossing = 0;
  for (int n = 1, passed = 0; passed < 2; ++n) {
    EXPECT_TRUE(solver->step(state, {}, h).ok());
    const double x = state.positions[1].x();
    if ((x < 0) != (before < 0)) ++passed, crossing = h * (n - x / (x - before));
    before = x;
  }
  return crossing / 0.75;  // the second crossing comes after three quarters
}

TEST(Pendulum, PeriodIsTheEllipticIntegral) {
  for (const DynamicsMethod method : kDynamicsMethods) {
    std::vector<double> errors;
    const double exact = 4 * std::sqrt(1 / kG) * std::comp_ellint_1(std::sin(0.5));
    for (const int rate : {120, 240, 480, 960})
      errors.push_back(std::abs(periodOf(method, 1, 1. / rate) - exact));
    EXPECT_NEAR(samples::orders(errors).back(), orderOf(method), kOrderSlack) << name(method);
    EXPECT_LT(errors.back(), orderOf(method) == 2 ? 2e-5 : 2e-3) << name(method);
  }
}

using Angles = std::array<double, 4>;  // θ₁, θ₂ from the vertical, and their rates; unit masses and lengths

Angles doublePendulum(const Angles& s) {
  const double d = s[0] - s[1], cosD = std::cos(d), sinD = std::sin(d);
  // 2θ₁″ + cos d θ₂″ = −sin d θ₂′² − 2g sin θ₁;  cos d θ₁″ + θ₂″ = sin d θ₁′² − g sin θ₂
  const double a = -sinD * s[3] * s[3] - 2 * kG * std::sin(s[0]),
               b = sinD * s[2] * s[2] - kG * std::sin(s[1]);
  const double det = 2 - cosD * cosD;
  return {s[2], s[3], (a - cosD * b) / det, (2 * b - cosD * a) / det};
}

// Gragg's midpoint rule extrapolated over 2, 4, 6, 8 substeps: order 8.
Angles graggStep(const Angles& s, double h) {
  std::array<Angles, 4> table{};
  for (int k = 0; k < 4; ++k) {
    const int n = 2 * (k + 1);
    const double dt = h / n;
    Angles before = s, now{};
    const Angles f0 = doublePendulum(s);
    for (int i = 0; i < 4; ++i) now[i] = s[i] + dt * f0[i];
    for (int m = 1; m < n; ++m) {
      const Angles f = doublePendulum(now);
      for (int i = 0; i < 4; ++i) before[i] += 2 * dt * f[i];
      std::swap(before, now);
    }
    const Angles f = doublePendulum(now);
    for (int i = 0; i < 4; ++i) table[k][i] = 0.5 * (now[i] + before[i] + dt * f[i]);
  }
  for (int level = 1; level < 4; ++level) {
    for (int k = 3; k >= level; --k) {
      const double ratio = double(k + 1) / double(k + 1 - level);
      for (int i = 0; i < 4; ++i) table[k][i] += (table[k][i] - table[k - 1][i]) / (ratio * ratio - 1);
    }
  }
  return table[3];
}

TEST(DoublePendulum, FollowsAnOrderEightReference) {
  const double time = 0.5;
  Angles s{1, 2, 0, 0};
  Angles coarse = s;
  for (int k = 0; k < 100; ++k) s = graggStep(s, time / 100);
  for (int k = 0; k < 50; ++k) coarse = graggStep(coarse, time / 50);
  ASSERT_LT(std::abs(s[1] - coarse[1]), 1e-10);  // the reference's own error
  const Vec3 tip(std::sin(s[0]) + std::sin(s[1]), -std::cos(s[0]) - std::cos(s[1]), 0);
  const std::vector<Vec3> points{
      {0, 0, 0}, {std::sin(1), -std::cos(1), 0}, {std::sin(1) + std::sin(2), -std::cos(1) - std::cos(2), 0}};
  ChainSet c = chainsFromCurves(points, std::vector<std::uint64_t>{0, 3}).value().chains;
  std::ranges::fill(c.masses, 1.0);
  for (const DynamicsMethod method : kDynamicsMethods) {
    std::vector<double> errors;
    for (const int rate : {480, 960, 1920}) {
      const auto solver = samples::solverFor(c, method);
      ChainState state = restState(c);
      samples::run(*solver, state, time, 1. / rate);
      errors.push_back((state.positions[2] - tip).norm());
    }
    EXPECT_NEAR(samples::orders(errors).back(), orderOf(method), kOrderSlack) << name(method);
    EXPECT_LT(errors.back(), orderOf(method) == 2 ? 1e-4 : 2e-2) << name(method);
  }
}

TEST(FreeFall, IsExactAndRigid) {
  ChainSet c = straightChain(6, 1, Vec3(1, 0, 0), 0.3, 5);
  c.freeRoots[0] = 1;
  const double h = 1. / 50;
  const int steps = 100;
  for (const DynamicsMethod method : {DynamicsMethod::Direct, DynamicsMethod::EnergyKeeping}) {
    const auto solver = samples::solverFor(c, method);
    ChainState state = restState(c);
    samples::run(*solver, state, steps * h, h);
    // Implicit Euler sums g h² k; the midpoint rule is exact for a parabola.
    const double fall = method == DynamicsMethod::Direct ? kG * h * h * steps * (steps + 1) / 2
                                                         : kG * h * h * steps * steps / 2;
    for (std::size_t i = 0; i < c.nodeCount(); ++i) {
      // A hundred additions of numbers near 20, each rounded to 4e-15.
      EXPECT_LE((state.positions[i] - c.restPositions[i] - Vec3(0, -fall, 0)).norm(), 1e-11) << name(method);
    }
  }
}

struct Momenta {
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
};
Momenta momenta(const ChainSet& c, const ChainState& s) {
  Momenta m;
  for (std::size_t i = 0; i < c.nodeCount(); ++i) {
    m.linear += c.masses[i] * s.velocities[i];
    m.angular += c.masses[i] * s.positions[i].cross(s.velocities[i]);
  }
  return m;
}

ChainSet zigzag(std::size_t links, double kappa) {
  std::vector<Vec3> points{{0, 0, 0}};
  for (std::size_t i = 0; i < links; ++i)
    points.push_back(points.back() + Vec3(0.1, i % 2 ? 0.06 : -0.06, 0.02 * double(i % 3)));
  ChainSet c =
      chainsFromCurves(points, std::vector<std::uint64_t>{0, points.size()}, {.bendingRigidity = kappa})
          .value()
          .chains;
  for (Vec3& rest : c.restDirections) rest = Vec3::UnitZ();  // wants to be straight
  return c;
}

TEST(FreeRoot, KeepsMomentumAndWithTheMidpointRuleSpinAndEnergy) {
  ChainSet c = zigzag(9, 0.05);
  c.freeRoots[0] = 1;
  for (const DynamicsMethod method :
       {DynamicsMethod::Direct, DynamicsMethod::DirectBdf2, DynamicsMethod::EnergyKeeping}) {
    SolverOptions options;
    options.method = method;
    options.gravity.setZero();
    options.tolerance = 1e-12;
    const auto solver = makeSolver(c, options).value();
    ChainState state = restState(c);
    for (std::size_t i = 0; i < c.nodeCount(); ++i)
      state.velocities[i] = Vec3(0.3, 0, 1) + Vec3(1, -3, 2).cross(state.positions[i]);
    const auto energy = [&] {
      ChainSet jointed = c;
      jointed.stiffness[1] = 0;  // a free root has no joint
      return chainEnergy(jointed, state, Vec3::Zero()).total();
    };
    const double energyBefore = energy();
    const Momenta before = momenta(c, state);
    samples::run(*solver, state, 1, 1. / 240);
    const Momenta after = momenta(c, state);
    // 240 solves, each stopped at 1e-12 of a link's length (0.1): velocities within 1e-12 · 0.1 · 2 · 240.
    constexpr double kStopped = 1e-8;
    EXPECT_LE((after.linear - before.linear).norm(), kStopped) << name(method);
    if (method == DynamicsMethod::EnergyKeeping) {
      EXPECT_LE((after.angular - before.angular).norm(), kStopped);
      EXPECT_NEAR(energy(), energyBefore, kStopped);
    }
  }
}

TEST(SpinningChain, StaysStraightAndKeepsItsSpeed) {
  const ChainSet c = straightChain(12, 1, Vec3(1, 0, 0), 0.1);
  const auto solver = samples::solverFor(c, DynamicsMethod::EnergyKeeping, Vec3::Zero());
  ChainState state = restState(c);
  const double spin = 20, h = 1. / 240;
  for (std::size_t i = 0; i < c.nodeCount(); ++i)
    state.velocities[i] = Vec3(0, 0, spin).cross(state.positions[i]);
  for (int k = 0; k < 240; ++k) ASSERT_TRUE(solver->step(state, {}, h).ok());
  // The midpoint rule turns by 2 atan(hΩ/2) a step: exact for the scheme, third order in hΩ for the motion.
  const double angle = 240 * 2 * std::atan(h * spin / 2);
  for (std::size_t i = 1; i < c.nodeCount(); ++i) {
    const Vec3 expected = c.restPositions[i].x() * Vec3(std::cos(angle), std::sin(angle), 0);
    EXPECT_LE((state.positions[i] - expected).norm(), 1e-7);  // 240 solves to 1e-9 of a link
    EXPECT_NEAR(state.velocities[i].norm(), spin * c.restPositions[i].x(), 1e-6);
  }
}

// Small swings of a hanging chain: ω = j₀ₖ/2 √(g/L), shape J₀(j₀ₖ √(s/L)), s from the tip.
double bessel(std::size_t links, double zero) {
  ChainSet c = straightChain(links, 1, Vec3(0, -1, 0));
  const double ell = 1. / double(links);
  for (std::size_t i = 0; i <= links; ++i) c.masses[i] = i == links ? ell / 2 : ell;
  const auto solver = samples::solverFor(c, DynamicsMethod::EnergyKeeping);
  ChainState state = restState(c);
  std::vector<double> shape;
  for (std::size_t i = 0; i <= links; ++i)
    shape.push_back(std::cyl_bessel_j(0, zero * std::sqrt(double(links - i) * ell)));
  for (std::size_t i = 1; i <= links; ++i) {
    const double dx = 1e-4 * (shape[i] - shape[i - 1]);
    state.positions[i] = state.positions[i - 1] + Vec3(dx, -std::sqrt(ell * ell - dx * dx), 0);
  }
  const auto amplitude = [&] {
    double a = 0;
    for (std::size_t i = 1; i <= links; ++i) a += c.masses[i] * shape[i] * state.positions[i].x();
    return a;
  };
  const double h = 1. / 1000;
  double before = amplitude(), crossing = 0;
  for (int n = 1, passed = 0; passed < 2; ++n) {
    EXPECT_TRUE(solver->step(state, {}, h).ok());
    const double now = amplitude();
    if ((now < 0) != (before < 0)) ++passed, crossing = h * (n - now / (now - before));
    before = now;
  }
  return crossing / 0.75;
}

TEST(HangingChain, SwingsInBesselModes) {
  const double zeros[] = {2.404825557695773, 5.520078110286311};
  for (const double zero : zeros) {
    const double exact = 2 * std::numbers::pi * 2 / (zero * std::sqrt(kG));
    std::vector<double> errors;
    for (const std::size_t links : {10, 20, 40}) errors.push_back(std::abs(bessel(links, zero) / exact - 1));
    EXPECT_LT(errors.back(), 3e-3) << zero;                  // the second mode has half a wave on 16 links
    EXPECT_GT(samples::orders(errors).back(), 1.6) << zero;  // second order in the link's length
  }
}

}  // namespace
}  // namespace coif
