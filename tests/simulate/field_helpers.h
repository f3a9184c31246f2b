// Nodes for field tests, and a field's force against differences of its energy.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "coif/base/random.h"
#include "coif/simulate/force_field.h"

namespace coif::simulatetest {

struct Nodes {
  std::vector<Vec3> positions, velocities;
  std::vector<double> masses, radii;
  NodeView view() const { return {positions, velocities, masses, radii}; }

  static Nodes cloud(std::size_t count, double size, double speed, std::uint64_t seed = 5) {
    const CounterRandom random(seed);
    Nodes out;
    for (std::size_t i = 0; i < count; ++i) {
      const auto vec = [&](std::uint64_t at) {
        return Vec3(random.uniform(8 * i + at) - 0.5, random.uniform(8 * i + at + 1) - 0.5,
                    random.uniform(8 * i + at + 2) - 0.5);
      };
      out.positions.push_back(size * vec(0));
      out.velocities.push_back(speed * vec(3));
      out.masses.push_back(0.5 + random.uniform(8 * i + 6));
      out.radii.push_back(0.02);
    }
    return out;
  }
};

inline Vec3 forceOf(const ForceField& field, std::uint32_t node, const Vec3& position, const Vec3& velocity,
                    Mat3* stiffness = nullptr) {
  Vec3 force = Vec3::Zero();
  Mat3 local = Mat3::Zero();
  field.add(node, position, velocity, force, local);
  if (stiffness) *stiffness = local;
  return force;
}

/// Central differences of the energy; error step² · third derivative + rounding / step.
inline Vec3 differences(const ForceField& field, std::uint32_t node, const Vec3& position, double step) {
  Vec3 out;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 by = step * Vec3::Unit(axis);
    out[axis] = (field.energy(node, position - by) - field.energy(node, position + by)) / (2 * step);
  }
  return out;
}

inline void expectPositiveSemidefinite(const Mat3& matrix) {
  EXPECT_LE((matrix - matrix.transpose()).cwiseAbs().maxCoeff(), 1e-12 * (1 + matrix.cwiseAbs().maxCoeff()));
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(matrix);
  EXPECT_GE(solver.eigenvalues()[0], -1e-12 * (1 + matrix.cwiseAbs().maxCoeff()));
}

}  // namespace coif::simulatetest
