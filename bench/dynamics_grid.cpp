#include "bench/dynamics_grid.h"

#include <algorithm>
#include <cmath>

namespace coif {

namespace {

constexpr double kStiffness[] = {0, 1e-3, 1, 1e6, 1e9, 1e12};
constexpr double kMassRatios[] = {1, 1e6};
constexpr GridDefect kDefects[] = {GridDefect::None, GridDefect::CoincidentNodes, GridDefect::FoldedBack,
                                   GridDefect::SpunRoot, GridDefect::NaNForce};
const Vec3 kGravity(0, -9.81, 0);

struct Motion {
  std::vector<Vec3> positions;
  std::vector<Mat3> frames;
};

Motion motionAt(const DynamicsGrid& g, int step) {
  Motion m;
  for (std::size_t t = 0; t < g.cases.size(); ++t) {
    const bool spun = g.cases[t].defect == GridDefect::SpunRoot;
    const Mat3 turn =
        Eigen::AngleAxisd(spun ? 2.0 * step : 0, Vec3(0.3, 0.1, 1).normalized()).toRotationMatrix();
    m.frames.push_back(turn * g.chains.rootFrames[t]);
    m.positions.emplace_back(spun ? 0.3 * (step % 3) : 0, 0, 0);
  }
  return m;
}

// Trees are plain chains: energies of one, without the others.
double energyOf(const DynamicsGrid& g, std::size_t tree) {
  const std::uint32_t begin = g.chains.treeOffsets[tree], end = g.chains.treeOffsets[tree + 1];
  double energy = 0;
  Vec3 before = g.state.rootFrames[tree].col(2);
  for (std::uint32_t i = begin + 1; i < end; ++i) {
    const Vec3 u = (g.state.positions[i] - g.state.positions[i - 1]).normalized();
    energy += 0.5 * g.chains.masses[i] * g.state.velocities[i].squaredNorm() -
              g.chains.masses[i] * kGravity.dot(g.state.positions[i]) +
              0.5 * g.chains.stiffness[i] * (u - before).squaredNorm();
    before = u;
  }
  return energy;
}

void deform(DynamicsGrid& g, std::size_t tree) {
  const std::uint32_t root = g.chains.treeOffsets[tree], end = g.chains.treeOffsets[tree + 1];
  std::vector<Vec3>& x = g.state.positions;
  if (g.cases[tree].defect == GridDefect::CoincidentNodes) x[end - 1] = x[end - 2];
  if (g.cases[tree].defect != GridDefect::FoldedBack) return;
  for (std::uint32_t i = root + 1; i < end; ++i) {  // every second link runs back onto the one before
    const Vec3 link = g.chains.restPositions[i] - g.chains.restPositions[i - 1];
    x[i] = x[i - 1] + ((i - root) % 2 ? link : Vec3(-link));
  }
}

// Energies of each chain: its lowest so far, its greatest size, whether it rose.
struct EnergyWatch {
  std::vector<double> lowest, scale;
  std::vector<std::uint8_t> rose;

  explicit EnergyWatch(std::size_t chains) : lowest(chains, HUGE_VAL), scale(chains, 0.0), rose(chains, 0) {}

  void look(const DynamicsGrid& g) {
    for (std::size_t t = 0; t < g.cases.size(); ++t) {
      if (g.cases[t].defect == GridDefect::SpunRoot) continue;  // its root does work
      const double energy = energyOf(g, t);
      scale[t] = std::max(scale[t], std::abs(energy));
      // What may come back: rounding of what the heavy tip weighs and stiff joints hold (single precision:
      // 1e-5).
      const double bound =
          scale[t] + 10 * (1 + g.cases[t].ratio * double(g.cases.size()) / double(g.chains.linkCount()));
      if (std::isfinite(lowest[t]) && !(energy <= lowest[t] + 1e-5 * bound)) rose[t] = 1;
      lowest[t] = std::min(lowest[t], energy);
    }
  }
};

void closeTally(const DynamicsGrid& g, bool floatLanes, GridTally& tally) {
  for (std::size_t t = 0; t < g.cases.size(); ++t) {
    bool finite = true;
    double stretch = 0;
    for (std::uint32_t i = g.chains.treeOffsets[t] + 1; i < g.chains.treeOffsets[t + 1]; ++i) {
      finite &= g.state.positions[i].allFinite() && g.state.velocities[i].allFinite();
      const double length = (g.state.positions[i] - g.state.positions[i - 1]).norm();
      stretch = std::max(stretch, std::abs(length / g.chains.lengths[i] - 1));
    }
    tally.notFinite += !finite;
    tally.stretched += !(stretch <= (floatLanes ? 1e-5 : 1e-9));
    tally.stretch = std::max(tally.stretch, stretch);
    ++tally.chains;
  }
}

}  // namespace

DynamicsGrid dynamicsGrid(std::size_t links) {
  DynamicsGrid g;
  for (const double kappa : kStiffness) {
    for (const double ratio : kMassRatios) {
      for (const GridDefect defect : kDefects) g.cases.push_back({kappa, ratio, defect});
    }
  }
  g.chains = repeated(straightChain(links, 1, Vec3(1, 0.1, 0), 1. / double(links)), g.cases.size());
  for (std::size_t t = 0; t < g.cases.size(); ++t) {
    const std::uint32_t root = g.chains.treeOffsets[t], end = g.chains.treeOffsets[t + 1];
    for (std::uint32_t i = root + 1; i < end; ++i) g.chains.stiffness[i] = g.cases[t].kappa;
    g.chains.masses[end - 1] *= g.cases[t].ratio;
  }
  g.state = restState(g.chains);
  for (std::size_t t = 0; t < g.cases.size(); ++t) deform(g, t);
  return g;
}

GridForce::GridForce(const DynamicsGrid& grid, bool bad) : bad_(bad) {
  for (std::size_t t = 0; t < grid.cases.size(); ++t) {
    flags_.insert(flags_.end(), grid.chains.treeOffsets[t + 1] - grid.chains.treeOffsets[t],
                  grid.cases[t].defect == GridDefect::NaNForce);
  }
}

void GridForce::add(std::uint32_t node, const Vec3&, const Vec3&, Vec3& force, Mat3&) const {
  if (bad_ && flags_[node]) force.x() += std::nan("");
}

GridTally& GridTally::operator+=(const GridTally& o) {
  const int sum = chainSteps + o.chainSteps;
  meanNewton = sum > 0 ? (meanNewton * chainSteps + o.meanNewton * o.chainSteps) / sum : 0;
  chainSteps = sum;
  chains += o.chains, notFinite += o.notFinite, stretched += o.stretched, risen += o.risen;
  wronglyReset += o.wronglyReset, notConverged += o.notConverged;
  mostNewton = std::max(mostNewton, o.mostNewton);
  stretch = std::max(stretch, o.stretch);
  left.insert(left.end(), o.left.begin(), o.left.end());
  return *this;
}

GridTally runGrid(DynamicsMethod method, std::size_t links, double timeStep, int steps, bool floatLanes,
                  int maxNewton) {
  DynamicsGrid g = dynamicsGrid(links);
  SolverOptions options;
  options.method = method;
  options.gravity = kGravity;
  options.floatLanes = floatLanes;
  options.maxNewton = maxNewton;
  const auto solver = makeSolver(g.chains, options).value();
  GridForce bad(g, true);
  ForceField* fields[] = {&bad};
  GridTally tally;
  EnergyWatch watch(g.cases.size());
  for (int k = 1; k <= steps; ++k) {
    const Motion motion = motionAt(g, k);
    const StepReport report =
        solver->step(g.state, fields, timeStep, {motion.positions, motion.frames}).value();
    tally.mostNewton = std::max(tally.mostNewton, report.maxNewton);
    tally.meanNewton += report.meanNewton / steps;
    tally.chainSteps += int(g.cases.size());
    for (const ChainFault& fault : report.faults) {
      const GridDefect defect = g.cases[fault.tree].defect;
      const bool due = defect == GridDefect::NaNForce || (defect == GridDefect::CoincidentNodes && k == 1);
      if (fault.kind == ChainFaultKind::NotConverged) {
        ++tally.notConverged;
        tally.left.push_back(fault.left);
      }
      tally.wronglyReset += fault.kind == ChainFaultKind::NotFinite && !due;
    }
    watch.look(g);
  }
  tally.risen = int(std::ranges::count(watch.rose, 1));
  closeTally(g, floatLanes, tally);
  return tally;
}

}  // namespace coif
