// Solvers to step chains with, and what is measured on them.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "bench/dynamics_problem.h"

namespace coif::samples {

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
