// Chains to step, and what is measured on them.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "coif/simulate/chain.h"
#include "coif/simulate/solver.h"

namespace coif::samples {

/// One chain of equal links from the origin along `direction`; every node weighs `mass`.
inline ChainSet straightChain(std::size_t links, double length, const Vec3& direction, double mass = 1,
                              double kappa = 0) {
  std::vector<Vec3> points;
  for (std::size_t i = 0; i <= links; ++i)
    points.push_back(direction.normalized() * (length * double(i) / double(links)));
  const std::vector<std::uint64_t> offsets{0, points.size()};
  ChainSet chains = chainsFromCurves(points, offsets).value().chains;
  std::ranges::fill(chains.masses, mass);
  std::ranges::fill(chains.stiffness, kappa);
  return chains;
}

inline ChainSet copies(const ChainSet& one, std::size_t count) {
  ChainSet all = one;
  const auto repeat = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  for (std::size_t k = 1; k < count; ++k) {
    const auto base = std::uint32_t(all.nodeCount());
    for (const std::uint32_t p : one.parents) all.parents.push_back(p == kNone ? kNone : p + base);
    for (std::size_t t = 0; t < one.treeCount(); ++t)
      all.treeOffsets.push_back(base + one.treeOffsets[t + 1]);
    repeat(all.lengths, one.lengths), repeat(all.restDirections, one.restDirections);
    repeat(all.stiffness, one.stiffness), repeat(all.masses, one.masses), repeat(all.drags, one.drags);
    repeat(all.radii, one.radii), repeat(all.restPositions, one.restPositions);
    repeat(all.rootFrames, one.rootFrames), repeat(all.freeRoots, one.freeRoots);
    all.sources.clear();
  }
  return all;
}

inline std::unique_ptr<Solver> solverFor(const ChainSet& chains, DynamicsMethod method,
                                         const Vec3& gravity = Vec3(0, -9.81, 0)) {
  SolverOptions options;
  options.method = method;
  options.gravity = gravity;
  options.iterations = 50;
  return makeSolver(chains, options).value();
}

/// Steps to `time` in steps of about `timeStep`; returns the report of the last.
inline StepReport run(Solver& solver, ChainState& state, double time, double timeStep) {
  const auto steps = std::size_t(std::lround(time / timeStep));
  StepReport report;
  int most = 0;
  for (std::size_t k = 0; k < steps; ++k) {
    report = solver.step(state, {}, time / double(steps)).value();
    most = std::max(most, report.maxNewton);
  }
  report.maxNewton = most;
  return report;
}

/// log₂ of the ratio of successive errors.
inline std::vector<double> orders(const std::vector<double>& errors) {
  std::vector<double> out;
  for (std::size_t i = 1; i < errors.size(); ++i) out.push_back(std::log2(errors[i - 1] / errors[i]));
  return out;
}

}  // namespace coif::samples
