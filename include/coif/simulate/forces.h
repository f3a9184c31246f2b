// Gravity and the drag of moving air.
#pragma once

#include <memory>
#include <vector>

#include "coif/simulate/air.h"
#include "coif/simulate/force_field.h"

namespace coif {

/// m g. Solvers have gravity built in, which is cheaper; this is for those who call fields alone.
class GravityField final : public ForceField {
 public:
  explicit GravityField(const Vec3& acceleration) : acceleration_(acceleration) {}
  void prepare(const NodeView& start, double, double, const Context&) override {
    masses_.assign(start.masses.begin(), start.masses.end());
  }
  void add(std::uint32_t node, const Vec3&, const Vec3&, Vec3& force, Mat3&) const override {
    force += masses_[node] * acceleration_;
  }
  double energy(std::uint32_t node, const Vec3& position) const override {
    return -masses_[node] * acceleration_.dot(position);
  }
  bool active() const override { return acceleration_ != Vec3::Zero(); }
  const char* idleReason() const override { return active() ? "" : "there is no gravity"; }

 private:
  Vec3 acceleration_;
  std::vector<double> masses_;
};

struct DragOptions {
  double linear = 0;     ///< per time, >= 0
  double quadratic = 0;  ///< per length, >= 0
};

/// −m (linear + quadratic |w|) w with w the velocity relative to the air; m g / that is the terminal speed.
/// Dissipative: its energy is 0. The air is taken where the node is at the step's start.
class DragField final : public ForceField {
 public:
  /// `air` may be null: still. It must outlive the field.
  explicit DragField(const DragOptions& options, Air* air = nullptr) : options_(options), air_(air) {}
  void prepare(const NodeView& start, double time, double timeStep, const Context& context) override;
  void add(std::uint32_t node, const Vec3& position, const Vec3& velocity, Vec3& force,
           Mat3& stiffness) const override;
  double energy(std::uint32_t, const Vec3&) const override { return 0; }
  bool active() const override { return options_.linear > 0 || options_.quadratic > 0; }
  const char* idleReason() const override { return active() ? "" : "air drag is 0, so wind moves nothing"; }

 private:
  DragOptions options_;
  Air* air_;
  double inverseStep_ = 0;
  std::vector<double> masses_;
  std::vector<Vec3> airVelocities_;
};

}  // namespace coif
