// Every combination of step, joint stiffness, mass ratio, length and defect; who else is touched by a bad
// chain; bytes, memory and sleep.
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <new>

#include "bench/dynamics_grid.h"
#include "bench/dynamics_head.h"
#include "simulate/chain_samples.h"

namespace {
std::atomic<std::size_t> gAllocations{0};
}  // namespace
// Counts every allocation of this program that goes through operator new.
void* operator new(std::size_t size) {
  ++gAllocations;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"  // it looks through the replaced operator
void operator delete(void* p) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}
#pragma GCC diagnostic pop

namespace coif {
namespace {

const Vec3 kGravity(0, -9.81, 0);

// As many steps as the bench tabulates: 720 chains, 22 500 chain-steps, every bar at nobody.
TEST(Torture, TheDirectSolverStandsTheWholeGrid) {
  GridTally sum;
  for (const std::size_t links : {1u, 2u, 30u, 1000u}) {
    for (const double h : {1. / 240, 1. / 24, 1.}) {
      const GridTally t = runGrid(DynamicsMethod::Direct, links, h, links > 100 ? 5 : 40);
      EXPECT_EQ(t.notFinite, 0) << links << " " << h;
      EXPECT_EQ(t.stretched, 0) << links << " " << h;
      EXPECT_EQ(t.risen, 0) << links << " " << h;
      EXPECT_EQ(t.wronglyReset, 0) << links << " " << h;
      EXPECT_LE(t.mostNewton, 20) << links << " " << h;
      sum += t;
    }
  }
  // Those that stop at twenty are folded back, spun or a million times heavier at the tip: measured 2.6 %.
  EXPECT_LE(double(sum.notConverged) / sum.chainSteps, 0.03);
}

// The spec's zero links never reach a solver: they are welded at build, and what is left is the chain without
// them, so that the grid above is theirs too.
TEST(Torture, ZeroLinksAreWeldedAway) {
  for (const std::size_t links : {1u, 2u, 30u}) {
    std::vector<Vec3> plain, doubled;
    for (std::size_t k = 0; k <= links; ++k) {
      plain.emplace_back(double(k) / double(links), 0.1 * double(k), 0);
      for (int twice = 0; twice < 2; ++twice) doubled.push_back(plain.back());
    }
    const std::vector<std::uint64_t> some{0, plain.size()}, all{0, doubled.size()};
    const ChainBuild build = chainsFromCurves(doubled, all).value();
    const ChainSet a = chainsFromCurves(plain, some).value().chains, &b = build.chains;
    EXPECT_EQ(build.report.weldedNodes, links + 1);
    EXPECT_EQ(a.parents, b.parents);
    EXPECT_EQ(a.lengths, b.lengths);
    EXPECT_EQ(a.masses, b.masses);
    EXPECT_EQ(a.restPositions, b.restPositions);
    ChainSet zero = a;  // made by hand it is refused, with the node's name
    zero.lengths[links] = 0;
    EXPECT_EQ(makeSolver(zero).error().place, "node " + std::to_string(links));
  }
}

// Cut off after any number of Newton steps a chain gains nothing: φ(end) <= φ(start) and the chain is slowed
// down by what it would gain (docs/simulate.md).
TEST(Torture, EnergyNeverRisesHoweverFewNewtonStepsThereAre) {
  for (const int most : {1, 2, 3}) {
    for (const double h : {1. / 240, 1. / 24, 1.}) {
      const GridTally t = runGrid(DynamicsMethod::Direct, 30, h, 40, false, most);
      EXPECT_EQ(t.risen, 0) << most << " " << h;
      EXPECT_EQ(t.notFinite + t.stretched + t.wronglyReset, 0) << most << " " << h;
      EXPECT_EQ(t.mostNewton, most);
    }
  }
}

TEST(Torture, FloatLanesKeepTheirLengthsAndGainNothing) {
  for (const std::size_t links : {1u, 2u, 30u, 100u, 1000u}) {
    for (const double h : {1. / 240, 1. / 24, 1.}) {
      const GridTally t = runGrid(DynamicsMethod::Direct, links, h, links > 30 ? 5 : 40, true);
      EXPECT_EQ(t.notFinite, 0) << links << " " << h;
      EXPECT_EQ(t.stretched, 0) << links << " " << h;
      EXPECT_EQ(t.risen, 0) << links << " " << h;
      EXPECT_EQ(t.wronglyReset, 0) << links << " " << h;
      EXPECT_LE(t.mostNewton, 20) << links << " " << h;
    }
  }
}

// What single precision does not hold is solved in double, chain by chain and to the bit.
TEST(FloatLanes, LeaveLongChainsAndFarMassesToDouble) {
  ChainSet c = repeated(straightChain(100, 1, Vec3(1, 0, 0), 0.01), 3);
  c.masses[c.treeOffsets[2] - 1] *= 1e5;  // the tip of tree 1, half a link's: 2e-5 … 1
  const ChainSet longer = straightChain(101, 1, Vec3(1, 0, 0), 0.01);
  SolverOptions options;
  std::vector<ChainState> ends;
  for (const bool single : {false, true}) {
    options.floatLanes = single;
    const auto solver = makeSolver(c, options).value();
    ChainState state = restState(c);
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(solver->step(state, {}, 1. / 100).value().inSingle, single ? 2u : 0u);
    ends.push_back(state);
    ChainState far = restState(longer);
    EXPECT_EQ(makeSolver(longer, options).value()->step(far, {}, 1. / 100).value().inSingle, 0u);
  }
  for (std::size_t t = 0; t < 3; ++t) {
    const std::uint32_t tip = c.treeOffsets[t + 1] - 1;
    EXPECT_EQ(ends[0].positions[tip] == ends[1].positions[tip], t == 1) << t;
  }
}

// What single precision costs: differences are what the kernel counts in, so a short step is as exact as a
// long one.
TEST(FloatLanes, AreAsNearAsDoubleOnesAtShortSteps) {
  ChainSet chains = repeated(straightChain(30, 1, Vec3(0.5, -0.9, 0), 1. / 30), 20);
  for (std::size_t t = 0; t < 20; ++t) {  // far from the origin, where a float's step is 4e-6
    for (std::uint32_t i = chains.treeOffsets[t]; i < chains.treeOffsets[t + 1]; ++i)
      chains.restPositions[i].x() += 60;
  }
  for (const DynamicsMethod method :
       {DynamicsMethod::Direct, DynamicsMethod::DirectBdf2, DynamicsMethod::EnergyKeeping}) {
    std::vector<ChainState> ends;
    for (const bool single : {false, true}) {
      SolverOptions options;
      options.method = method;
      options.floatLanes = single;
      options.tolerance = single ? 1e-5 : 1e-9;
      const auto solver = makeSolver(chains, options).value();
      ChainState state = restState(chains);
      const StepReport report = samples::run(*solver, state, 0.5, 1. / 1008);
      EXPECT_LE(report.maxNewton, 4) << name(method);
      ends.push_back(state);
    }
    EXPECT_LE(maxStretch(chains, ends[1].positions), 1e-6);  // a length in single precision
    double worst = 0;
    for (std::size_t i = 0; i < chains.nodeCount(); ++i)
      worst = std::max(worst, (ends[0].positions[i] - ends[1].positions[i]).norm());
    // 504 steps whose turns are rounded at 6e-8 of a link; Euler's own error here is 1e-3.
    EXPECT_LE(worst, 1e-4) << name(method);
  }
}

// The others are run, not judged (the bench tabulates how they fail): what they hand out is finite, for a
// chain that fails is reset.
TEST(Torture, EveryMethodHandsOutFiniteNumbers) {
  for (const DynamicsMethod method : kDynamicsMethods) {
    for (const std::size_t links : {1u, 2u, 30u}) {
      for (const double h : {1. / 240, 1. / 24, 1.})
        EXPECT_EQ(runGrid(method, links, h, 4).notFinite, 0) << name(method) << " " << links << " " << h;
    }
  }
}

TEST(Isolation, ABadChainIsResetReportedAndTouchesNobody) {
  for (const DynamicsMethod method : kDynamicsMethods) {
    DynamicsGrid good = dynamicsGrid(5), bad = dynamicsGrid(5);
    SolverOptions options;
    options.method = method;
    const auto a = makeSolver(good.chains, options).value(), b = makeSolver(bad.chains, options).value();
    GridForce harmless(good, false), harmful(bad, true);
    ForceField *none[] = {&harmless}, *nan[] = {&harmful};
    for (int k = 0; k < 5; ++k) {
      ASSERT_TRUE(a->step(good.state, none, 1. / 100).ok());
      const StepReport report = b->step(bad.state, nan, 1. / 100).value();
      std::size_t resets = 0;
      for (const ChainFault& f : report.faults) resets += bad.cases[f.tree].defect == GridDefect::NaNForce;
      EXPECT_EQ(resets, good.cases.size() / 5) << name(method);  // one defect of five
    }
    for (std::size_t t = 0; t < good.cases.size(); ++t) {
      if (good.cases[t].defect == GridDefect::NaNForce) continue;
      for (std::uint32_t i = good.chains.treeOffsets[t]; i < good.chains.treeOffsets[t + 1]; ++i)
        ASSERT_EQ(good.state.positions[i], bad.state.positions[i]) << name(method) << " " << t;
    }
  }
}

TEST(Isolation, BadRootsAndStatesAreReset) {
  const ChainSet c = repeated(straightChain(4, 1, Vec3(0, -1, 0), 1, 1), 3);
  const auto solver = samples::solverFor(c, DynamicsMethod::Direct);
  ChainState state = restState(c);
  state.positions[7] = Vec3(std::nan(""), 0, 0);  // of tree 1
  std::vector<Vec3> roots(3, Vec3::Zero());
  roots[2].y() = HUGE_VAL;
  const StepReport report = solver->step(state, {}, 0.01, {roots, {}}).value();
  ASSERT_EQ(report.faults.size(), 2u);
  EXPECT_EQ(report.faults[0].tree, 1u);
  EXPECT_EQ(report.faults[1].tree, 2u);
  for (std::size_t i = 0; i < c.nodeCount(); ++i) EXPECT_TRUE(state.positions[i].allFinite());
  EXPECT_LE(maxStretch(c, state.positions), 1e-9);
  EXPECT_TRUE(solver->step(state, {}, 0.01).value().faults.empty());
  EXPECT_FALSE(solver->step(state, {}, -1).ok());
  EXPECT_FALSE(solver->step(state, {}, 0.01, {std::span(roots).first(2), {}}).ok());
}

ChainSet mixed() {
  ChainSet all = repeated(straightChain(12, 1, Vec3(1, 0, 0), 0.1, 0.01), 60);
  const auto base = std::uint32_t(all.nodeCount());
  for (std::uint32_t i = 1; i < base; ++i) {
    if (all.parents[i] != kNone) all.stiffness[i] *= 1 + 0.01 * (i % 7);
  }
  for (std::size_t t = 0; t + 1 < 60; t += 2) {
    for (std::uint32_t k = 1; k < 13; ++k)
      all.laterals.push_back({all.treeOffsets[t] + k, all.treeOffsets[t + 1] + k, 3, Vec3(0, 0, 0.01)});
  }
  return all;
}

bool sameBytes(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0;
}

TEST(Determinism, SameBytesForAnyNumberOfThreadsAndAfterAResume) {
  const ChainSet c = mixed();
  for (const DynamicsMethod method : kDynamicsMethods) {
    std::vector<ChainState> ends;
    for (const int threads : {1, 2, 5}) {
      auto solver = samples::solverFor(c, method);
      ChainState state = restState(c);
      Context context;
      context.threads = threads;
      for (int k = 0; k < 20; ++k) {
        if (k == 9 && threads == 5) solver = samples::solverFor(c, method);  // as after an interruption
        ASSERT_TRUE(solver->step(state, {}, 1. / 200, {}, context).ok());
      }
      ends.push_back(state);
    }
    for (const ChainState& end : ends) {
      EXPECT_TRUE(sameBytes(end.positions, ends[0].positions)) << name(method);
      EXPECT_TRUE(sameBytes(end.velocities, ends[0].velocities)) << name(method);
    }
  }
}

// Everything that acts at once: head, density, fluid.
TEST(Determinism, SameBytesForAnyNumberOfThreadsWithHeadDensityAndFluid) {
  std::vector<ChainState> ends;
  for (const int threads : {1, 2, 5}) {
    HeadProblem::Options options;
    options.trees = 300;
    options.fluid = true;
    options.threads = threads;
    HeadProblem problem(options);
    for (int k = 0; k < 12; ++k) EXPECT_EQ(problem.step(1. / 60).solved, 300u);
    EXPECT_GT(problem.collisions().nearCount(), 0u);
    ends.push_back(problem.state());
  }
  for (const ChainState& end : ends) {
    EXPECT_TRUE(sameBytes(end.positions, ends[0].positions));
    EXPECT_TRUE(sameBytes(end.velocities, ends[0].velocities));
  }
}

TEST(Memory, AStepAllocatesNothing) {
  const ChainSet c = mixed();
  for (const DynamicsMethod method : kDynamicsMethods) {
    for (const int threads : {1, 2}) {
      const auto solver = samples::solverFor(c, method);
      ChainState state = restState(c);
      Context context;
      context.threads = threads;
      ASSERT_TRUE(solver->step(state, {}, 1. / 200, {}, context).ok());
      const std::size_t before = gAllocations.load();
      for (int k = 0; k < 5; ++k) (void)solver->step(state, {}, 1. / 200, {}, context);
      EXPECT_EQ(gAllocations.load(), before) << name(method) << " threads " << threads;
    }
  }
}

TEST(Sleep, ChainsAtRestAreSkippedUntilTheirRootMoves) {
  const ChainSet c = repeated(straightChain(8, 1, Vec3(0, -1, 0), 0.1), 20);
  SolverOptions options;
  options.sleepSpeed = 1e-3;
  const auto solver = makeSolver(c, options).value();
  ChainState state = restState(c);
  StepReport report;
  for (int k = 0; k < 15; ++k) report = solver->step(state, {}, 0.01).value();
  EXPECT_EQ(report.asleep, 20u);
  EXPECT_EQ(report.maxNewton, 0);
  std::vector<Vec3> roots(20, Vec3::Zero());
  roots[7].x() = 0.05;
  report = solver->step(state, {}, 0.01, {roots, {}}).value();
  EXPECT_EQ(report.asleep, 19u);
  EXPECT_GT(state.velocities[c.treeOffsets[8] - 1].norm() + state.velocities[c.treeOffsets[7] + 1].norm(),
            0.1);
  options.sleepSpeed = 0;  // the switch
  const auto awake = makeSolver(c, options).value();
  for (int k = 0; k < 15; ++k) report = awake->step(state, {}, 0.01).value();
  EXPECT_EQ(report.asleep, 0u);
}

// A chain at rest feels its neighbour through their springs, and wakes.
TEST(Sleep, ANeighboursPullWakesAChain) {
  ChainSet c = repeated(straightChain(6, 1, Vec3(0, -1, 0), 0.1), 2);
  for (std::uint32_t k = 1; k < 7; ++k) c.laterals.push_back({k, 7 + k, 50, Vec3::Zero()});
  SolverOptions options;
  options.sleepSpeed = 1e-3;
  const auto solver = makeSolver(c, options).value();
  ChainState state = restState(c);
  for (int k = 0; k < 15; ++k) (void)solver->step(state, {}, 0.01).value();
  EXPECT_EQ(solver->step(state, {}, 0.01).value().asleep, 2u);
  std::vector<Vec3> roots(2, Vec3::Zero());
  for (int k = 0; k < 20; ++k) {
    roots[0].x() += 0.01;
    (void)solver->step(state, {}, 0.01, {roots, {}}).value();
  }
  EXPECT_LT(state.positions[1].x(), 0.2 - 1e-2);       // tree 0 trails behind its root
  EXPECT_GT(std::abs(state.positions[13].x()), 1e-3);  // and takes tree 1 along, whose root stands still
}

// Two chains let go at right angles; the mean distance of their tips over two seconds.
double meanTipDistance(double stiffness) {
  ChainSet c = repeated(straightChain(6, 1, Vec3(0, -1, 0), 0.2), 2);
  for (std::uint32_t k = 1; k < 7 && stiffness > 0; ++k)
    c.laterals.push_back({k, 7 + k, stiffness, Vec3::Zero()});
  ChainState state = restState(c);
  for (std::uint32_t i = 1; i < 7; ++i)
    state.positions[i] = state.positions[i - 1] + c.lengths[i] * Vec3(1, 0, 0);
  SolverOptions options;
  options.lateralPasses = 3;
  const auto solver = makeSolver(c, options).value();
  double energy = chainEnergy(c, state, kGravity).total(), sum = 0;
  for (int k = 0; k < 200; ++k) {
    EXPECT_TRUE(solver->step(state, {}, 1. / 100).ok());
    const double now = chainEnergy(c, state, kGravity).total();
    EXPECT_LE(now, energy + 1e-6) << k;  // what Newton's tolerance leaves
    energy = now;
    sum += (state.positions[6] - state.positions[13]).norm() / 200;
  }
  return sum;
}

TEST(Lateral, SpringsHoldNeighboursTogetherAndGainNoEnergy) {
  const double loose = meanTipDistance(0), soft = meanTipDistance(50), firm = meanTipDistance(5000);
  EXPECT_LT(soft, 0.9 * loose);
  EXPECT_LT(firm, 0.2 * loose);
}

// Two pendulums with a spring between their links, let go to opposite sides: a quarter of their period.
double quarterOfOppositeSwings(double step) {
  constexpr double kSwing = 1e-3;
  ChainSet c = repeated(straightChain(1, 0.5, Vec3(0, -1, 0), 0.5), 2);
  c.masses[1] = c.masses[3] = 2;
  c.laterals.push_back({1, 3, 40, Vec3::Zero()});
  ChainState state = restState(c);
  state.positions[1] = 0.5 * Vec3(std::sin(kSwing), -std::cos(kSwing), 0);
  state.positions[3] = 0.5 * Vec3(-std::sin(kSwing), -std::cos(kSwing), 0);
  SolverOptions options;
  options.method = DynamicsMethod::EnergyKeeping;
  options.lateralPasses = 3;
  options.tolerance = 1e-12;
  const auto solver = makeSolver(c, options).value();
  double time = 0, before = state.positions[1].x();
  while (before > 0 && time < 1) {
    EXPECT_TRUE(solver->step(state, {}, step).ok());
    const double now = state.positions[1].x();
    EXPECT_NEAR(now, -state.positions[3].x(), 1e-3 * kSwing);  // who is solved first lags a little
    time += now > 0 ? step : step * before / (before - now);
    before = now;
  }
  return time;
}

// ω² = g/ℓ + 2k/m, for ½k|d_b − d_a|² is 2kℓ²θ² at θ and −θ. Neighbours pull as they stand at the step's end:
// of first order.
TEST(Lateral, OppositeSwingsHaveTheFrequencyOfCoupledPendulums) {
  const double quarter = std::acos(-1.) / 2 / std::sqrt(9.81 / 0.5 + 2 * 40 / 2.);
  const double coarse = std::abs(quarterOfOppositeSwings(1e-3) - quarter),
               fine = std::abs(quarterOfOppositeSwings(5e-4) - quarter);
  EXPECT_LE(fine, 5e-4 * quarter);
  EXPECT_NEAR(coarse / fine, 2, 0.2);
}

TEST(SkippedBending, ChangesNothingButTime) {
  const ChainSet c = straightChain(20, 1, Vec3(1, 0, 0), 0.1);
  std::vector<ChainState> ends;
  for (const bool skip : {true, false}) {
    SolverOptions options;
    options.skipBending = skip;
    options.tolerance = 1e-12;
    const auto solver = makeSolver(c, options).value();
    ChainState state = restState(c);
    samples::run(*solver, state, 0.5, 1. / 240);
    ends.push_back(state);
  }
  for (std::size_t i = 0; i < c.nodeCount(); ++i)
    EXPECT_LE((ends[0].positions[i] - ends[1].positions[i]).norm(), 1e-8);  // 120 solves to 1e-12, amplified
}

}  // namespace
}  // namespace coif
