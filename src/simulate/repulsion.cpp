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
  const double push = options_.stiffness * mass, firm = push / volume, perCell = 1 / frame_.cell;
  double density = 0;
  Vec3 momentum = Vec3::Zero();
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t j = 0; j < 3; ++j) {
      const double y = stencil.weight[1][j], z = stencil.weight[2][k], yz0 = y * z;
      const double sy = stencil.slope[1][j] * z * perCell, sz = y * stencil.slope[2][k] * perCell;
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t index =
            frame_.index(stencil.first[0] + long(i), stencil.first[1] + long(j), stencil.first[2] + long(k));
        const float* cell = &grid_[index * kChannels];
        const double x = stencil.weight[0][i], w = x * yz0;
        density += w * double(cell[0]);
        momentum += w * Vec3(cell[1], cell[2], cell[3]);
        const double over = double(cell[0]) - options_.restDensity;
        if (slopes_.empty() || !(over > 0)) continue;
        const Vec3 slope(stencil.slope[0][i] * yz0 * perCell, x * sy, x * sz);
        local.force -= (push * over) * slope;
        // (Σ a_j)(Σ a_j)ᵀ ⪯ Σ (S / s_j) a_j a_jᵀ with S = Σ s_j, for any s_j > 0 (Cauchy–Schwarz): what makes
        // K a majorant. Here s_j is the sum of a_j's components.
        const double steep = std::abs(slope[0]) + std::abs(slope[1]) + std::abs(slope[2]);
        if (!(steep > 0)) continue;
        const Vec3 scaled = (firm * double(slopes_[index]) / steep) * slope;
        xx += scaled[0] * slope[0], xy += scaled[0] * slope[1], xz += scaled[0] * slope[2];
        yy += scaled[1] * slope[1], yz += scaled[1] * slope[2], zz += scaled[2] * slope[2];
      }
    }
  }
  local.stiffness << xx, xy, xz, xy, yy, yz, xz, yz, zz;
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
