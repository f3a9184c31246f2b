// Every combination of step, joint stiffness, mass ratio, length and defect; who else is touched by a bad
// chain; bytes, memory and sleep.
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <map>
#include <new>

#include "coif/base/random.h"
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

enum class Defect { None, CoincidentNodes, FoldedBack, SpunRoot, NaNForce };
constexpr Defect kDefects[] = {Defect::None, Defect::CoincidentNodes, Defect::FoldedBack, Defect::SpunRoot,
                               Defect::NaNForce};
constexpr double kStiffness[] = {0, 1e-3, 1, 1e6, 1e9, 1e12};
constexpr double kMassRatios[] = {1, 1e6};

struct Case {
  double kappa, ratio;
  Defect defect;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const double kappa : kStiffness) {
    for (const double ratio : kMassRatios) {
      for (const Defect defect : kDefects) all.push_back({kappa, ratio, defect});
    }
  }
  return all;
}

// One chain a case, level at the start, one unit long; a mass ratio makes the tip heavy.
struct Grid {
  ChainSet chains;
  ChainState state;
  std::vector<Case> list = cases();
};

Grid makeGrid(std::size_t links) {
  Grid g;
  g.chains =
      samples::copies(samples::straightChain(links, 1, Vec3(1, 0.1, 0), 1. / double(links)), g.list.size());
  for (std::size_t t = 0; t < g.list.size(); ++t) {
    const std::uint32_t root = g.chains.treeOffsets[t], end = g.chains.treeOffsets[t + 1];
    for (std::uint32_t i = root + 1; i < end; ++i) g.chains.stiffness[i] = g.list[t].kappa;
    g.chains.masses[end - 1] *= g.list[t].ratio;
  }
  g.state = restState(g.chains);
  for (std::size_t t = 0; t < g.list.size(); ++t) {
    const std::uint32_t root = g.chains.treeOffsets[t], end = g.chains.treeOffsets[t + 1];
    if (g.list[t].defect == Defect::CoincidentNodes) g.state.positions[end - 1] = g.state.positions[end - 2];
    if (g.list[t].defect != Defect::FoldedBack) continue;
    for (std::uint32_t i = root + 1; i < end; ++i) {  // every second link runs back onto the one before
      const Vec3 link = g.chains.restPositions[i] - g.chains.restPositions[i - 1];
      g.state.positions[i] = g.state.positions[i - 1] + ((i - root) % 2 ? link : Vec3(-link));
    }
  }
  return g;
}

class BadForce : public ForceField {
 public:
  BadForce(const Grid& grid, bool bad) : bad_(bad) {
    for (std::size_t t = 0; t < grid.list.size(); ++t) {
      flags_.insert(flags_.end(), grid.chains.treeOffsets[t + 1] - grid.chains.treeOffsets[t],
                    grid.list[t].defect == Defect::NaNForce);
    }
  }
  void prepare(const NodeView&, double, double, const Context&) override {}
  void add(std::uint32_t node, const Vec3&, const Vec3&, Vec3& force, Mat3&) const override {
    if (bad_ && flags_[node]) force.x() += std::nan("");
  }
  double energy(std::uint32_t, const Vec3&) const override { return 0; }

 private:
  std::vector<std::uint8_t> flags_;
  bool bad_;
};

struct Motion {
  std::vector<Vec3> positions;
  std::vector<Mat3> frames;
};
// Spun roots turn by two radians a step, about an axis across the chain, and are thrown about.
Motion motionAt(const Grid& g, int step) {
  Motion m;
  for (std::size_t t = 0; t < g.list.size(); ++t) {
    const bool spun = g.list[t].defect == Defect::SpunRoot;
    const Mat3 turn =
        Eigen::AngleAxisd(spun ? 2.0 * step : 0, Vec3(0.3, 0.1, 1).normalized()).toRotationMatrix();
    m.frames.push_back(turn * g.chains.rootFrames[t]);
    m.positions.emplace_back(Vec3(spun ? 0.3 * (step % 3) : 0, 0, 0));
  }
  return m;
}

double energyOf(const Grid& g, std::size_t tree) {
  ChainSet one = g.chains;  // the sum over one tree: everything else without weight
  for (std::size_t t = 0; t < g.list.size(); ++t) {
    if (t == tree) continue;
    for (std::uint32_t i = one.treeOffsets[t]; i < one.treeOffsets[t + 1]; ++i)
      one.masses[i] = 0, one.stiffness[i] = 0;
  }
  return chainEnergy(one, g.state, kGravity).total();
}

struct Tally {
  int notFinite = 0, stretched = 0, risen = 0, notConverged = 0, reset = 0, runs = 0, most = 0;
};

// A few steps of every case, all chains side by side.
Tally torture(DynamicsMethod method, std::size_t links, double h, int steps, bool floats) {
  Grid g = makeGrid(links);
  SolverOptions options;
  options.method = method;
  options.floatLanes = floats;
  const auto solver = makeSolver(g.chains, options).value();
  const BadForce none(g, false);
  BadForce bad(g, true);
  ForceField* fields[] = {&bad};
  std::vector<double> start(g.list.size(), HUGE_VAL), first(g.list.size(), 0.0);
  Tally tally;
  std::vector<std::uint8_t> rose(g.list.size(), 0);
  for (int k = 1; k <= steps; ++k) {
    const Motion motion = motionAt(g, k);
    const StepReport report = solver->step(g.state, fields, h, {motion.positions, motion.frames}).value();
    tally.most = std::max(tally.most, report.maxNewton);
    for (const ChainFault& fault : report.faults) {
      const bool reset = fault.kind == ChainFaultKind::NotFinite;
      ++(reset ? tally.reset : tally.notConverged);
      const Defect defect = g.list[fault.tree].defect;
      if (reset && links < 1000) {
        EXPECT_TRUE(defect == Defect::NaNForce || (defect == Defect::CoincidentNodes && k == 1) ||
                    method < DynamicsMethod::Direct)
            << name(method) << " links " << links << " tree " << fault.tree << " h " << h;
      }
    }
    for (std::size_t t = 0; t < g.list.size() && links <= 30; ++t) {
      if (g.list[t].defect == Defect::SpunRoot) continue;  // its root does work
      const double energy = energyOf(g, t);
      // Implicit Euler gives up energy. What may come back: a Newton solve that stopped at its limit,
      // measured at 2e-6 of the energy that a folded chain of stiff joints starts with; rounding of the heavy
      // tip's.
      first[t] = std::max(first[t], std::abs(energy));
      const double scale = first[t] + 10 * (1 + g.list[t].ratio / double(links));
      if (std::isfinite(start[t]) && !(energy <= start[t] + 1e-5 * scale)) rose[t] = 1;
      start[t] = std::min(start[t], energy);
    }
  }
  for (std::size_t t = 0; t < g.list.size(); ++t) {
    bool finite = true;
    double stretch = 0;
    for (std::uint32_t i = g.chains.treeOffsets[t] + 1; i < g.chains.treeOffsets[t + 1]; ++i) {
      finite &= g.state.positions[i].allFinite() && g.state.velocities[i].allFinite();
      stretch = std::max(
          stretch,
          std::abs((g.state.positions[i] - g.state.positions[i - 1]).norm() / g.chains.lengths[i] - 1));
    }
    tally.notFinite += !finite;
    tally.stretched += !(stretch <= (floats ? 1e-5 : 1e-9));
    tally.risen += rose[t];
    ++tally.runs;
  }
  return tally;
}

TEST(Torture, TheDirectSolverStandsTheWholeGrid) {
  for (const std::size_t links : {1u, 2u, 30u, 1000u}) {
    for (const double h : {1. / 240, 1. / 24, 1.}) {
      const Tally t = torture(DynamicsMethod::Direct, links, h, links > 100 ? 2 : 8, false);
      EXPECT_EQ(t.notFinite, 0) << links << " " << h;
      EXPECT_EQ(t.stretched, 0) << links << " " << h;
      EXPECT_EQ(t.risen, 0) << links << " " << h;
      EXPECT_LE(t.most, 20) << links << " " << h;
      std::printf("links %4zu h %.4f: most Newton steps %d, not converged %d, reset %d\n", links, h, t.most,
                  t.notConverged, t.reset);
    }
  }
}

TEST(Torture, FloatLanesKeepTheirLengths) {
  for (const std::size_t links : {1u, 2u, 30u}) {
    for (const double h : {1. / 240, 1. / 24, 1.}) {
      const Tally t = torture(DynamicsMethod::Direct, links, h, 4, true);
      EXPECT_EQ(t.notFinite, 0) << links << " " << h;
      EXPECT_EQ(t.stretched, 0) << links << " " << h;
    }
  }
}

// The others are run, not judged: what they hand out must still be finite, for failures are reset.
TEST(Torture, EveryMethodHandsOutFiniteNumbers) {
  for (const DynamicsMethod method : kDynamicsMethods) {
    Tally sum;
    for (const std::size_t links : {1u, 2u, 30u}) {
      for (const double h : {1. / 240, 1. / 24, 1.}) {
        const Tally t = torture(method, links, h, 6, false);
        EXPECT_EQ(t.notFinite, 0) << name(method) << " " << links << " " << h;
        sum.runs += t.runs, sum.stretched += t.stretched, sum.risen += t.risen, sum.reset += t.reset;
        sum.notConverged += t.notConverged;
      }
    }
    std::printf("%-24s of %d: stretched %d, energy risen %d; steps reset %d, not converged %d\n",
                name(method), sum.runs, sum.stretched, sum.risen, sum.reset, sum.notConverged);
  }
}

TEST(Isolation, ABadChainIsResetReportedAndTouchesNobody) {
  for (const DynamicsMethod method : kDynamicsMethods) {
    Grid good = makeGrid(5), bad = makeGrid(5);
    SolverOptions options;
    options.method = method;
    const auto a = makeSolver(good.chains, options).value(), b = makeSolver(bad.chains, options).value();
    BadForce harmless(good, false), harmful(bad, true);
    ForceField *none[] = {&harmless}, *nan[] = {&harmful};
    for (int k = 0; k < 5; ++k) {
      ASSERT_TRUE(a->step(good.state, none, 1. / 100).ok());
      const StepReport report = b->step(bad.state, nan, 1. / 100).value();
      std::size_t resets = 0;
      for (const ChainFault& f : report.faults) resets += bad.list[f.tree].defect == Defect::NaNForce;
      EXPECT_EQ(resets, std::size(kStiffness) * std::size(kMassRatios)) << name(method);
    }
    for (std::size_t t = 0; t < good.list.size(); ++t) {
      if (good.list[t].defect == Defect::NaNForce) continue;
      for (std::uint32_t i = good.chains.treeOffsets[t]; i < good.chains.treeOffsets[t + 1]; ++i)
        ASSERT_EQ(good.state.positions[i], bad.state.positions[i]) << name(method) << " " << t;
    }
  }
}

TEST(Isolation, BadRootsAndStatesAreReset) {
  const ChainSet c = samples::copies(samples::straightChain(4, 1, Vec3(0, -1, 0), 1, 1), 3);
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
  ChainSet all = samples::copies(samples::straightChain(12, 1, Vec3(1, 0, 0), 0.1, 0.01), 60);
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
  const ChainSet c = samples::copies(samples::straightChain(8, 1, Vec3(0, -1, 0), 0.1), 20);
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

// Two chains let go at right angles; the mean distance of their tips over two seconds.
double meanTipDistance(double stiffness) {
  ChainSet c = samples::copies(samples::straightChain(6, 1, Vec3(0, -1, 0), 0.2), 2);
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

TEST(SkippedBending, ChangesNothingButTime) {
  const ChainSet c = samples::straightChain(20, 1, Vec3(1, 0, 0), 0.1);
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
