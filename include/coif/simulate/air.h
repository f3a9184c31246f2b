// What the air does: still, a steady wind, gusts, or a coarse fluid that hair and head stand in.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "coif/base/random.h"
#include "coif/base/result.h"
#include "coif/simulate/force_field.h"
#include "coif/strands/point_splat.h"

namespace coif {

/// The velocity of the air at a point, in the caller's units.
class Air {
 public:
  virtual ~Air() = default;
  /// Once a step, at its start.
  virtual void prepare(const NodeView&, double /*time*/, double /*timeStep*/, const Context&) {}
  /// Thread-safe, no allocation.
  virtual Vec3 velocity(const Vec3& position) const = 0;
};

class ConstantWind final : public Air {
 public:
  explicit ConstantWind(const Vec3& velocity) : velocity_(velocity) {}
  Vec3 velocity(const Vec3&) const override { return velocity_; }

 private:
  Vec3 velocity_;
};

struct GustOptions {
  Vec3 mean = Vec3::Zero();  ///< steady part; gusts drift with it
  double speed = 1;          ///< root mean square of the gusts
  double size = 1;           ///< of an eddy, > 0
  double turnover = 1;       ///< time in which one pattern becomes another, > 0
  std::uint64_t seed = 1;
};

/// Mean wind and gusts: the curl of value noise with quintic blending (Bridson et al. 2007), so divergence is
/// zero but for rounding, everywhere. Counter-based: a pure function of place, time and seed. Lattice values
/// repeat after 2^32 cells.
class GustyWind final : public Air {
 public:
  explicit GustyWind(const GustOptions& options) : options_(options) {}
  void prepare(const NodeView&, double time, double, const Context&) override { time_ = time; }
  Vec3 velocity(const Vec3& position) const override { return velocityAt(position, time_); }
  Vec3 velocityAt(const Vec3& position, double time) const;

 private:
  GustOptions options_;
  double time_ = 0;
};

struct FluidOptions {
  Vec3 mean = Vec3::Zero();                        ///< free stream: what flows in, and the state at the start
  Vec3 lo = Vec3(-1, -1, -1), hi = Vec3(1, 1, 1);  ///< the box that is solved; free stream outside
  int cells = 24;                                  ///< along its longest side, 4 … 128
  double hairDrag = 0;      ///< rate at which air takes on the hair's velocity, times volume a mass
  double tolerance = 1e-5;  ///< greatest divergence left × cell / greatest speed
  int maxIterations = 400;
};

/// The solid that stands in the air: signed distance (negative inside) and velocity at a point.
struct AirObstacle {
  std::function<double(const Vec3&)> distance;
  std::function<Vec3(const Vec3&)> velocity;
};

struct FluidReport {
  int iterations = 0;
  double divergence = 0;  ///< greatest of a fluid cell × cell / greatest speed, after projection
  double seconds = 0;
};

/// Stable fluids (Stam 1999) on a staggered grid: second-order semi-Lagrangian advection, hair as porous drag
/// (implicit, so any rate is stable), solid faces take the obstacle's velocity, projection by conjugate
/// gradients with zero pressure outside the box. Cost a step: O(cells³ · iterations), in parallel.
class FluidWind final : public Air {
 public:
  static Result<std::unique_ptr<FluidWind>> create(const FluidOptions& options, AirObstacle obstacle = {});
  ~FluidWind() override;
  /// Advances the air by the time step, before the hair moves.
  void prepare(const NodeView& nodes, double time, double timeStep, const Context& context) override;
  Vec3 velocity(const Vec3& position) const override;
  void setObstacle(AirObstacle obstacle);  ///< where it is from now on
  const FluidReport& report() const;
  /// All that a step changes, to save and resume: face velocities and the pressure.
  std::vector<double> state() const;
  Status restore(std::span<const double> state);

 private:
  struct Impl;
  explicit FluidWind(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace coif
