// Dynamics: every solver over time steps and stiffnesses, against a converged reference; energy, the torture
// grid, speed, and what leaving things out saves.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "bench/bench.h"
#include "bench/bench_text.h"
#include "bench/dynamics_grid.h"
#include "bench/dynamics_head.h"

namespace coif {

namespace {

const Vec3 kGravity(0, -9.81, 0);
constexpr double kDiverged = 10;  // chain lengths, or energies: whoever is off by more has blown up

std::unique_ptr<Solver> solverFor(const ChainSet& chains, DynamicsMethod method, double tolerance = 1e-6) {
  SolverOptions options;
  options.method = method;
  options.gravity = kGravity;
  options.tolerance = tolerance;
  return require(makeSolver(chains, options));
}

// Sixteen chains of twenty links, let go at different angles.
ChainSet problemChains(double kappa) {
  ChainSet all = repeated(straightChain(20, 1, Vec3(1, 0, 0), 1. / 20, kappa), 16);
  for (std::size_t t = 0; t < 16; ++t) {
    const double angle = (20 + 4 * double(t)) * std::numbers::pi / 180;
    const Vec3 along(std::sin(angle), -std::cos(angle), 0);
    const std::uint32_t begin = all.treeOffsets[t];
    for (std::uint32_t i = begin; i < all.treeOffsets[t + 1]; ++i)
      all.restPositions[i] = along * (double(i - begin) / 20);
    all.rootFrames[t] = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), along).toRotationMatrix();
  }
  if (kappa > 0) {  // a stiff chain that swings: the root's joint is soft
    for (std::size_t t = 0; t < 16; ++t) all.stiffness[all.treeOffsets[t] + 1] = 0.01;
  }
  return all;
}

struct Swing {
  std::vector<Vec3> tips;
  double stretch = 0, seconds = 0;  ///< of a link for a simulated second
  bool failed = false;
};

Swing swing(const ChainSet& chains, DynamicsMethod method, int rate, double time, double tolerance,
            const Context& context) {
  const auto solver = solverFor(chains, method, tolerance);
  ChainState state = restState(chains);
  Swing out;
  const int steps = int(std::lround(rate * time));
  for (int k = 0; k < steps; ++k) {
    const StepReport report = require(solver->step(state, {}, time / steps, {}, context));
    out.seconds += report.seconds;
    for (const ChainFault& fault : report.faults) out.failed |= fault.kind == ChainFaultKind::NotFinite;
  }
  out.seconds /= time * double(chains.linkCount());
  out.stretch = maxStretch(chains, state.positions);
  for (std::size_t t = 0; t < chains.treeCount(); ++t)
    out.tips.push_back(state.positions[chains.treeOffsets[t + 1] - 1]);
  return out;
}

double rms(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
  return std::sqrt(sum / double(a.size()));
}

void measureTips(const BenchOptions& options, BenchReport& report) {
  const double time = 0.5;
  const std::vector<int> rates =
      options.quick ? std::vector{120, 480} : std::vector{60, 120, 240, 480, 960, 1920};
  const int fine = options.quick ? 3840 : 15360;
  const std::vector<std::pair<double, std::string>> kinds{{0, "limp"}, {0.02, "soft"}, {1e4, "stiff"}};
  for (const auto& [kappa, kind] : kinds) {
    const ChainSet chains = problemChains(kappa);
    const Swing truth = swing(chains, DynamicsMethod::EnergyKeeping, fine, time, 1e-12, options.context);
    const Swing half = swing(chains, DynamicsMethod::EnergyKeeping, fine / 2, time, 1e-12, options.context);
    const double own = rms(truth.tips, half.tips) / 3;  // second order: the finer is nearer by a factor of 4
    BenchPlot tip, stretch;
    tip.name = "dynamics-tip-" + kind;
    tip.title = "Tip after half a second, " + kind + " joints (" + shortNumber(kappa) + ")";
    tip.errorUnit = "RMS, of the chain's length";
    tip.truth = "energy-keeping step at 1/" + std::to_string(fine) + " s, itself within " + shortNumber(own);
    stretch = tip;
    stretch.name = "dynamics-stretch-" + kind;
    stretch.title = "Worst link after half a second, " + kind + " joints";
    stretch.errorUnit = "of the link's length";
    stretch.truth = "links are rigid";
    for (const DynamicsMethod method : kDynamicsMethods) {
      for (const int rate : rates) {
        const Swing run = swing(chains, method, rate, time, 1e-6, options.context);
        const double error = rms(run.tips, truth.tips);
        BenchSample sample{name(method), {{"step", "1/" + std::to_string(rate)}}, 0, run.seconds, 0};
        const bool diverged = run.failed || !(error < kDiverged);
        sample.parameters.emplace_back("outcome", diverged ? "diverged" : "");
        sample.error = diverged ? kDiverged : std::max(error, own);
        tip.samples.push_back(sample);
        sample.error = run.stretch < kDiverged ? run.stretch : kDiverged;
        stretch.samples.push_back(sample);
      }
    }
    tip.rateAgainst(name(DynamicsMethod::Direct), {{"step", "1/120"}, {"outcome", ""}});
    stretch.rateAgainst(name(DynamicsMethod::Direct), {{"step", "1/120"}, {"outcome", ""}});
    report.plots.push_back(std::move(tip));
    report.plots.push_back(std::move(stretch));
  }
}

struct EnergyRun {
  double worst = 0, last = 0, seconds = 0;
};

// Thirty links let go at 30 degrees, undamped. Errors are of what could be lost: the energy above hanging.
EnergyRun energyRun(DynamicsMethod method, int rate, double time, const Context& context) {
  const double angle = std::numbers::pi / 6;
  const ChainSet chains = straightChain(30, 1, Vec3(std::sin(angle), -std::cos(angle), 0), 1. / 30);
  const auto solver = solverFor(chains, method);
  ChainState state = restState(chains);
  const double start = chainEnergy(chains, state, kGravity).total();
  const double above = start * (1 - 1 / std::cos(angle));  // hanging straight down: start / cos
  EnergyRun run;
  for (int k = 0; k < int(time * rate); ++k) {
    const StepReport report = require(solver->step(state, {}, 1. / rate, {}, context));
    run.seconds += report.seconds;
    run.last = std::abs(chainEnergy(chains, state, kGravity).total() - start) / above;
    if (!(run.last < kDiverged) || !report.faults.empty()) run.last = kDiverged;
    run.worst = std::max(run.worst, run.last);
  }
  run.seconds /= time * double(chains.linkCount());
  return run;
}

void measureEnergy(const BenchOptions& options, BenchReport& report) {
  const double time = options.quick ? 2 : 10;
  BenchPlot plot;
  plot.name = "dynamics-energy";
  plot.title = "Energy of 30 undamped links let go at 30 degrees, " + shortNumber(time) + " s";
  plot.errorUnit = "of the energy above hanging, worst; 10: blew up";
  plot.truth = "the energy at the start";
  for (const DynamicsMethod method : kDynamicsMethods) {
    for (const int rate : options.quick ? std::vector{24, 240} : std::vector{24, 60, 120, 240, 480, 1000}) {
      const EnergyRun run = energyRun(method, rate, time, options.context);
      plot.samples.push_back(
          {name(method), {{"step", "1/" + std::to_string(rate)}}, run.worst, run.seconds, 0});
      if (rate != 240 && rate != 24) continue;
      BenchFigure figure{std::string("energy error at 1/") + std::to_string(rate) + ", " + name(method),
                         run.worst, "of what could be lost"};
      if (method == DynamicsMethod::EnergyKeeping) figure.kind = Bar::AtMost, figure.bar = 0.004;
      report.figures.push_back(figure);
    }
  }
  report.plots.push_back(std::move(plot));
}

void measureGrid(const BenchOptions& options, BenchReport& report) {
  for (const DynamicsMethod method : kDynamicsMethods) {
    GridTally sum;
    for (const std::size_t links : {1u, 2u, 30u, 1000u}) {
      if (options.quick && links == 1000) continue;
      for (const double h : {1. / 240, 1. / 24, 1.}) {
        const int steps = options.quick ? 2 : links == 1000 ? 5 : 40;
        sum += runGrid(method, links, h, steps);
      }
    }
    const bool direct = method == DynamicsMethod::Direct;
    const auto add = [&](const std::string& what, double value, const std::string& unit, double bar) {
      BenchFigure figure{std::string("torture, ") + name(method) + ": " + what, value, unit};
      if (direct && bar >= 0) figure.kind = Bar::AtMost, figure.bar = bar;
      report.figures.push_back(figure);
    };
    const std::string of = "of " + std::to_string(sum.chains);
    add("chains not finite", sum.notFinite, of, 0);
    add("chains stretched beyond 1e-9", sum.stretched, of, 0);
    add("greatest stretch", sum.stretch, "of the link", 1e-9);
    add("chains whose energy rose without work", sum.risen, of, 0);
    add("chain-steps reset without a cause", sum.wronglyReset, "of " + std::to_string(sum.chainSteps), 0);
    if (method < DynamicsMethod::Direct) continue;
    add("chain-steps that stopped at 20 Newton steps", double(sum.notConverged) / sum.chainSteps, "of all",
        -1);
    std::ranges::sort(sum.left);
    if (!sum.left.empty())
      add("of these, a node still moved in the last step by, median", sum.left[sum.left.size() / 2],
          "of a link", -1);
    add("Newton steps, mean", sum.meanNewton, "", -1);
    add("Newton steps, most", sum.mostNewton, "", 20);
  }
  GridTally floats;
  for (const std::size_t links : {1u, 2u, 30u, 1000u}) {
    for (const double h : {1. / 240, 1. / 24, 1.})
      floats += runGrid(DynamicsMethod::Direct, links, h, 4, true);
  }
  report.figures.push_back(
      {"torture, float lanes: greatest stretch", floats.stretch, "of the link", Bar::AtMost, 1e-5});
}

// Fastest of `repeats` runs of some steps of swinging chains, for one step.
double secondsAStep(const ChainSet& chains, const SolverOptions& options, double h, int threads, int steps,
                    int repeats) {
  const auto solver = require(makeSolver(chains, options));
  ChainState state = restState(chains);
  Context context;
  context.threads = threads;
  for (int k = 0; k < 10; ++k) (void)require(solver->step(state, {}, h, {}, context));
  double best = HUGE_VAL;
  for (int r = 0; r < repeats; ++r) {
    double sum = 0;
    for (int k = 0; k < steps; ++k) sum += require(solver->step(state, {}, h, {}, context)).seconds;
    best = std::min(best, sum / steps);
  }
  return best;
}

void measureSpeed(const BenchOptions& options, BenchReport& report) {
  SolverOptions choice;
  choice.gravity = kGravity;
  choice.tolerance = 1e-6;
  const ChainSet large = repeated(straightChain(30, 1, Vec3(1, 0.2, 0), 1. / 30, 0.01), 120);
  const ChainSet small = repeated(straightChain(4, 1, Vec3(1, 0.2, 0), 1. / 4, 0.01), 30);
  const int repeats = options.quick ? 5 : 40;
  for (const DynamicsMethod method : kDynamicsMethods) {
    choice.method = method;
    const double a = secondsAStep(large, choice, 1. / 240, 1, 5, repeats);
    report.figures.push_back({std::string("120 x 30, one thread, ") + name(method), a * 1e3, "ms a step"});
    report.figures.push_back(
        {std::string("120 x 30, one thread, ") + name(method) + ": a link", a * 1e6 / 3600, "us"});
    const double b = secondsAStep(small, choice, 1. / 240, 1, 50, repeats);
    report.figures.push_back({std::string("30 x 4, one thread, ") + name(method), b * 1e3, "ms a step"});
  }
  choice.method = DynamicsMethod::Direct;
  const double frame = secondsAStep(small, choice, 1. / 24, 1, 50, repeats);
  report.figures.push_back(
      {"30 x 4: frames a second on one thread, a step a frame (the paper, on its own machine: 92)", 1 / frame,
       "frames/s", Bar::AtLeast, 92});
}

// Fastest step of hair that falls over a head, for each of the options: in turns, so that a busy machine is
// busy for all.
std::vector<double> secondsOnHead(const std::vector<HeadProblem::Options>& options, double h, int repeats) {
  std::vector<std::unique_ptr<HeadProblem>> problems;
  for (const HeadProblem::Options& o : options) problems.push_back(std::make_unique<HeadProblem>(o));
  std::vector<double> best(options.size(), HUGE_VAL);
  for (int r = -2; r < repeats; ++r) {
    for (std::size_t p = 0; p < problems.size(); ++p) {
      const double seconds = problems[p]->step(h).seconds;
      if (r >= 0) best[p] = std::min(best[p], seconds);
    }
  }
  return best;
}

void measureHead(const BenchOptions& options, BenchReport& report) {
  HeadProblem::Options one;
  one.trees = options.quick ? 500 : 10000;
  one.links = 32;
  one.threads = 1;
  HeadProblem::Options two = one;
  two.threads = 2;
  const int repeats = options.quick ? 2 : 8;
  const std::string title = (options.quick ? "500" : "10 000") + std::string(" x 32 on a head, dense");
  const std::vector<double> times = secondsOnHead({one, two}, 1. / 24, repeats);
  const double alone = times[0], both = times[1];
  report.figures.push_back({title + ": frames a second, one thread", 1 / alone, "1/s"});
  report.figures.push_back({title + ": frames a second, two threads", 1 / both, "1/s"});
  BenchFigure scaling{title + ": one thread's time / two threads'", alone / both, ""};
  // Meaningless where the machine has one core.
  if (benchMachine().threads >= 2 && !options.quick) scaling.kind = Bar::AtLeast, scaling.bar = 1.7;
  report.figures.push_back(scaling);

  HeadProblem::Options away = one;
  away.trees = options.quick ? 500 : 2000;
  away.headAway = 5;
  away.stiffness = 0;
  HeadProblem::Options kept = away, grid = away;
  kept.keepCollisions = true;
  grid.stiffness = 0.25;
  grid.density = 1e3;  // nothing is that dense
  const std::vector<double> idle = secondsOnHead({away, kept, grid}, 1. / 240, 3 * repeats);
  const auto saving = [&](const std::string& what, double without) {
    report.figures.push_back({"saved by " + what, 1 - idle[0] / without, "of a step"});
    if (!options.quick) report.figures.back().kind = Bar::AtLeast;  // a few steps say nothing of a time
  };
  saving("leaving out collisions where nothing is near", idle[1]);
  saving("no density grid where repulsion is off", idle[2]);
}

void measureSavings(const BenchOptions& options, BenchReport& report) {
  const int repeats = options.quick ? 5 : 20;
  const ChainSet limp = repeated(straightChain(30, 1, Vec3(0, -1, 0), 1. / 30), 200);
  SolverOptions plain, choice;
  plain.gravity = choice.gravity = kGravity;
  plain.tolerance = choice.tolerance = 1e-9;
  plain.skipBending = false;
  const auto saving = [&](const std::string& what, double with, double without) {
    report.figures.push_back({"saved by " + what, 1 - with / without, "of a step"});
    if (!options.quick) report.figures.back().kind = Bar::AtLeast;
  };
  const auto time = [&](const ChainSet& chains, const SolverOptions& o) {
    return secondsAStep(chains, o, 1. / 240, 1, 4, repeats);
  };
  ChainSet swinging = limp;
  for (Vec3& x : swinging.restPositions) x = Vec3(-x.y(), 0.1 * x.y(), 0) / std::sqrt(1.01);
  const double full = time(swinging, plain);
  choice.skipBending = true;
  saving("leaving out bending where stiffness is 0", time(swinging, choice), full);
  choice = plain;
  choice.tolerance = 1e-4;
  saving("stopping Newton at 1e-4 of a link, not 1e-9", time(swinging, choice), full);
  choice = plain;
  choice.sleepSpeed = 1e-3;
  choice.sleepSteps = 5;
  saving("sleeping while nothing moves", time(limp, choice), time(limp, plain));
  choice = plain;
  choice.floatLanes = true;
  choice.tolerance = plain.tolerance = 1e-4;
  saving("float lanes", time(swinging, choice), time(swinging, plain));
}

}  // namespace

BenchReport benchDynamics(const BenchOptions& options) {
  BenchReport report;
  report.title = "Dynamics";
  report.about =
      "Chains of rigid links under gravity. The tip plots let sixteen chains of twenty links (a metre, a "
      "kilogram) "
      "swing for half a second from 20 to 80 degrees; each solver runs at several time steps, the seconds "
      "are one "
      "link's for a simulated second. The projecting solvers make twenty sweeps a step. The energy plot lets "
      "thirty undamped links go at 30 degrees. The torture grid crosses time steps 1/240, 1/24 and 1 with "
      "joint "
      "stiffness 0 to 1e12, mass ratio 1 and 1e6, 1 to 1000 links, and nothing wrong, coincident nodes, "
      "links "
      "folded back, a root spun by two radians a step, and forces that are not numbers; a chain's energy may "
      "rise "
      "by 1e-5 of its scale. Speed is the fastest of many repeats, without fields; "
      "hair on a head falls over it with collisions, density repulsion and drag.";
  measureTips(options, report);
  measureEnergy(options, report);
  measureGrid(options, report);
  measureSpeed(options, report);
  measureHead(options, report);
  measureSavings(options, report);
  return report;
}

}  // namespace coif
