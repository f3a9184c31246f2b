#include "coif/simulate/forces.h"

#include "coif/base/parallel.h"

namespace coif {

void DragField::prepare(const NodeView& start, double time, double timeStep, const Context& context) {
  if (!active()) return;
  inverseStep_ = 1 / timeStep;
  masses_.assign(start.masses.begin(), start.masses.end());
  airVelocities_.assign(start.positions.size(), Vec3::Zero());
  if (!air_) return;
  air_->prepare(start, time, timeStep, context);
  parallelFor(context, start.positions.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) airVelocities_[i] = air_->velocity(start.positions[i]);
  });
}

void DragField::add(std::uint32_t node, const Vec3&, const Vec3& velocity, Vec3& force,
                    Mat3& stiffness) const {
  const Vec3 relative = velocity - airVelocities_[node];
  const double speed = relative.norm();
  const double rate = masses_[node] * (options_.linear + options_.quadratic * speed);
  force -= rate * relative;
  stiffness.diagonal().array() += rate * inverseStep_;
  if (options_.quadratic > 0 && speed > 0)
    stiffness += masses_[node] * options_.quadratic * inverseStep_ / speed * relative * relative.transpose();
}

}  // namespace coif
