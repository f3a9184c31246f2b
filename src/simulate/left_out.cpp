#include "simulate/left_out.h"

#include <algorithm>
#include <cstdio>

namespace coif::simulate {

namespace {

std::string text(const char* format, double a, double b = 0) {
  char out[128];
  std::snprintf(out, sizeof out, format, a, b);
  return out;
}

bool byNewton(DynamicsMethod method) {
  return method == DynamicsMethod::Direct || method == DynamicsMethod::DirectBdf2 ||
         method == DynamicsMethod::EnergyKeeping;
}

// Fields that there are not because nothing in the settings asks for them.
void addUnwanted(const DynamicsSettings& s, const SimulationReport& report, std::vector<LeftOut>& out) {
  const auto has = [&](const char* name) {
    return std::ranges::any_of(report.fields, [&](const FieldUse& use) { return use.name == name; });
  };
  if (!has("collisions")) {
    out.push_back(
        {"collisions", "collide", s.collide ? "there is no head and no capsule" : "it is off", 1, "steps"});
  }
  if (!has("repulsion"))
    out.push_back({"the density grid", "repulsion", "repulsion and hairFriction are 0", 1, "steps"});
  if (!has("wind"))
    out.push_back({"a field of air", "wind", "the air is still: its drag is part of the solve", 1, "steps"});
}

void addIdle(const SimulationReport& report, std::vector<LeftOut>& out) {
  for (const FieldUse& use : report.fields) {
    if (use.steps == report.steps) continue;
    const bool grid = use.name == "repulsion";
    out.push_back({use.name,
                   use.name == "collisions" ? "collide"
                   : grid                   ? "repulsion"
                                            : "drag",
                   use.idleReason, 1 - double(use.steps) / double(report.steps), "steps"});
  }
}

}  // namespace

std::size_t limpTrees(const ChainSet& c) {
  std::size_t limp = 0;
  for (std::size_t t = 0; t < c.treeCount(); ++t) {
    limp += std::all_of(c.stiffness.begin() + c.treeOffsets[t] + 1,
                        c.stiffness.begin() + c.treeOffsets[t + 1], [](double k) { return k == 0; });
  }
  return limp;
}

std::vector<LeftOut> leftOut(const DynamicsSettings& s, const SimulationReport& report) {
  std::vector<LeftOut> out;
  if (report.steps == 0) return out;
  const double solves = double(report.chainSteps), all = solves + double(report.asleep);
  if (report.asleep > 0) {
    out.push_back({"chains at rest", "sleepSpeed",
                   text("slower than %g m/s for %g s, and nothing that acts on them changed", s.sleepSpeed,
                        s.sleepSeconds),
                   double(report.asleep) / all, "chain-steps"});
  }
  if (report.limp > 0) {
    out.push_back({"bending terms", "skipBending", "no joint of the chain has stiffness",
                   double(report.limp) / double(report.chains), "chains"});
  }
  const double stopped = solves - double(report.unconverged);
  if (byNewton(s.method) && stopped > 0) {
    out.push_back({text("Newton steps after %.2g of 20", report.meanNewton), "tolerance",
                   text("what is left would move no node by %g of a link", s.tolerance), stopped / solves,
                   "chain-steps that were solved"});
  }
  if (report.inSingle > 0) {
    out.push_back({"double precision", "precision", "single is asked for, and the chain is short enough",
                   double(report.inSingle) / double(report.chains), "chains"});
  }
  addUnwanted(s, report, out);
  addIdle(report, out);
  return out;
}

}  // namespace coif::simulate
