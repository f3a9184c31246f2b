#include <algorithm>
#include <cmath>

#include "coif/simulate/solver.h"
#include "simulate/binning.h"

namespace coif {

ChainEnergy chainEnergy(const ChainSet& c, const ChainState& state, const Vec3& gravity) {
  ChainEnergy e;
  std::vector<Mat3> frames(c.nodeCount());
  linkFrames(c, state.positions, state.rootFrames, frames);
  const auto link = [&](std::uint32_t i) -> Vec3 {
    return state.positions[i] - state.positions[c.parents[i]];
  };
  for (std::uint32_t i = 0; i < c.nodeCount(); ++i) {
    e.kinetic += 0.5 * c.masses[i] * state.velocities[i].squaredNorm();
    e.gravity -= c.masses[i] * gravity.dot(state.positions[i]);
    if (c.parents[i] == kNone) continue;
    const Vec3 off = frames[i].col(2) - frames[c.parents[i]] * c.restDirections[i];
    e.bending += 0.5 * c.stiffness[i] * off.squaredNorm();
  }
  if (c.laterals.empty()) return e;
  const std::vector<std::uint32_t> treeOf = treeOfNodes(c);
  for (const LateralSpring& s : c.laterals) {
    const Vec3 off = link(s.b) - link(s.a) - state.rootFrames[treeOf[s.a]] * s.rest;
    e.lateral += 0.5 * s.stiffness * off.squaredNorm();
  }
  return e;
}

double maxStretch(const ChainSet& c, std::span<const Vec3> positions) {
  double worst = 0;
  for (std::uint32_t i = 0; i < c.nodeCount(); ++i) {
    if (c.parents[i] == kNone) continue;
    const double ratio = (positions[i] - positions[c.parents[i]]).norm() / c.lengths[i];
    worst = std::max(worst, std::isfinite(ratio) ? std::abs(ratio - 1) : HUGE_VAL);
  }
  return worst;
}

ChainState restState(const ChainSet& c) {
  ChainState s;
  s.positions = s.previousPositions = c.restPositions;
  s.velocities = s.previousVelocities = std::vector<Vec3>(c.nodeCount(), Vec3::Zero());
  s.rootFrames = c.rootFrames;
  s.quietSteps.assign(c.treeCount(), 0);
  s.quietForces.assign(c.nodeCount(), Vec3::Zero());
  return s;
}

}  // namespace coif
