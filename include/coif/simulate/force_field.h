// What acts on the nodes of chains from outside: gravity, wind, collisions, repulsion.
#pragma once

#include <cstdint>
#include <span>

#include "coif/base/context.h"
#include "coif/base/vec.h"

namespace coif {

/// Nodes as a force field sees them; arrays of N. Units are the caller's own, consistently.
struct NodeView {
  std::span<const Vec3> positions, velocities;
  std::span<const double> masses;
  std::span<const double> radii;  ///< thickness of hair around a node, for collisions
};

/// A force on every node with its linearisation, for explicit and implicit solvers alike. A field either has
/// a potential (then force = −∇ energy) or is dissipative (then energy() is that of its step: what line
/// searches may use, or 0).
class ForceField {
 public:
  virtual ~ForceField() = default;
  /// Once a step, before anything else, at the step's start: update grids, neighbour lists, lagged normals.
  virtual void prepare(const NodeView& start, double time, double timeStep, const Context& context) = 0;
  /// Adds, for node `node` at a trial position and velocity, the force and −∂f/∂x − (1/h) ∂f/∂v, symmetric
  /// and positive semi-definite. Thread-safe, no allocation; called for any node in any order.
  virtual void add(std::uint32_t node, const Vec3& position, const Vec3& velocity, Vec3& force,
                   Mat3& stiffness) const = 0;
  /// Potential of the node there, for line searches; 0 for what has none.
  virtual double energy(std::uint32_t node, const Vec3& position) const = 0;
  /// Whether the field can act on anything this step; a field that cannot is left out of the solve.
  virtual bool active() const { return true; }
  /// Why it is left out, for reports; empty while it is active.
  virtual const char* idleReason() const { return ""; }
};

}  // namespace coif
