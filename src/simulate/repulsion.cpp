#include "coif/simulate/repulsion.h"

#include <algorithm>
#include <cmath>

#include "coif/base/parallel.h"

namespace coif {

namespace {
constexpr std::size_t kChannels = 4;  // mass, momentum
constexpr std::size_t kGrain = 1024;
}  // namespace

const char* RepulsionField::idleReason() const {
  if (active_) return "";
  return options_.stiffness > 0 || options_.friction > 0 ? "hair is nowhere denser than its rest density"
                                                         : "repulsion is off";
}

void RepulsionField::prepare(const NodeView& start, double, double timeStep, const Context& context) {
  active_ = false;
  if (!(options_.stiffness > 0) && !(options_.friction > 0)) return;
  inverseStep_ = 1 / timeStep;
  const std::size_t count = start.positions.size();
  masses_.assign(start.masses.begin(), start.masses.end());
  points_.assign(start.positions.begin(), start.positions.end());
  values_.resize(count * kChannels);
  Vec3 lo = Vec3::Constant(1e300), hi = Vec3::Constant(-1e300);
  for (std::size_t i = 0; i < count; ++i) {
    if (!start.velocities[i].allFinite() || !(points_[i].cwiseAbs().maxCoeff() < 1e150))
      points_[i].setConstant(std::nan(""));
    values_[i * kChannels] = masses_[i];
    for (int axis = 0; axis < 3; ++axis)
      values_[i * kChannels + 1 + std::size_t(axis)] = masses_[i] * start.velocities[i][axis];
    if (!points_[i].allFinite()) continue;
    lo = lo.cwiseMin(points_[i]);
    hi = hi.cwiseMax(points_[i]);
  }
  if (!(lo[0] <= hi[0])) return;
  frame_ = frameAround(lo, hi, options_.cell, options_.maxLog2Size);
  const double volume = frame_.cell * frame_.cell * frame_.cell;
  for (double& value : values_) value /= volume;
  splatter_.splat(frame_, points_, values_, kChannels, grid_, context);

  maxDensity_ = 0;
  for (std::size_t g = 0; g < grid_.size(); g += kChannels)
    maxDensity_ = std::max(maxDensity_, double(grid_[g]));
  energy_ = 0;
  const bool pushes = options_.stiffness > 0 && maxDensity_ > options_.restDensity;
  if (!pushes && !(options_.friction > 0)) return;
  active_ = true;
  if (pushes) {
    splatter_.splatSlopes(frame_, points_, masses_, slopes_, context);
    energy_ = parallelSum(context, grid_.size() / kChannels, 4096, [&](std::size_t begin, std::size_t end) {
      double sum = 0;
      for (std::size_t g = begin; g < end; ++g) {
        const double over = std::max(0.0, double(grid_[g * kChannels]) - options_.restDensity);
        sum += over * over;
      }
      return 0.5 * options_.stiffness * volume * sum;
    });
  } else {
    slopes_.clear();
  }
  locals_.resize(count);
  parallelFor(context, count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) linearise(start, i, timeStep);
  });
}

void RepulsionField::linearise(const NodeView& start, std::size_t node, double timeStep) {
  Local& local = locals_[node];
  local = {};
  const Vec3& position = points_[node];
  if (!position.allFinite()) return;
  local.start = position;
  const SplatStencil stencil(frame_.cellsFromWorld(position));
  const double volume = frame_.cell * frame_.cell * frame_.cell, mass = masses_[node];
  double density = 0;
  Vec3 momentum = Vec3::Zero();
  stencil.forEach([&](long i, long j, long k, double w, const Vec3& perCell) {
    const std::size_t index = frame_.index(i, j, k);
    const float* cell = &grid_[index * kChannels];
    density += w * cell[0];
    momentum += w * Vec3(cell[1], cell[2], cell[3]);
    const double over = cell[0] - options_.restDensity;
    if (slopes_.empty() || !(over > 0)) return;
    const Vec3 slope = perCell / frame_.cell;
    local.force -= options_.stiffness * mass * over * slope;
    const double steep = slope.norm();
    // (Σ_j a_j)(Σ_j a_j)ᵀ ⪯ Σ_j (S / |a_j|) a_j a_jᵀ with S = Σ |a_j|: what makes K a majorant.
    if (steep > 0)
      local.stiffness +=
          options_.stiffness / volume * slopes_[index] * mass / steep * slope * slope.transpose();
  });
  if (density > 0) local.meanVelocity = momentum / density;
  local.carried = position + timeStep * local.meanVelocity;
  local.friction = mass * options_.friction;
  if (!start.velocities[node].allFinite() || !local.force.allFinite() || !local.stiffness.allFinite())
    local = {};
}

void RepulsionField::add(std::uint32_t node, const Vec3& position, const Vec3& velocity, Vec3& force,
                         Mat3& stiffness) const {
  const Local& local = locals_[node];
  force += local.force - local.stiffness * (position - local.carried);
  stiffness += local.stiffness;
  if (local.friction > 0) {
    force -= local.friction * (velocity - local.meanVelocity);
    stiffness.diagonal().array() += local.friction * inverseStep_;
  }
}

double RepulsionField::energy(std::uint32_t node, const Vec3& position) const {
  const Local& local = locals_[node];
  const Vec3 off = position - local.carried;
  return -local.force.dot(position - local.start) + 0.5 * off.dot(local.stiffness * off);
}

double RepulsionField::densityAt(const Vec3& position) const {
  if (grid_.empty() || !position.allFinite()) return 0;
  double density = 0;
  SplatStencil(frame_.cellsFromWorld(position)).forEach([&](long i, long j, long k, double w, const Vec3&) {
    density += w * grid_[frame_.index(i, j, k) * kChannels];
  });
  return density;
}

}  // namespace coif
