// Stable fluids on a staggered grid with porous hair and a solid head.
#include "coif/base/report.h"
#include "simulate/fluid_impl.h"

namespace coif {

namespace {
constexpr std::size_t kGrain = 512;
}

double FluidWind::Impl::sample(int axis, const Vec3& position) const {
  const Vec3 cells = (position - options.lo) / cell;
  const auto dims = faceDims(axis);
  std::array<long, 3> base{};
  Vec3 t;
  for (int a = 0; a < 3; ++a) {
    if (!(cells[a] >= 0 && cells[a] <= double(n[std::size_t(a)]))) return options.mean[axis];
    const double top = double(dims[std::size_t(a)] - 1);
    const double at = std::clamp(a == axis ? cells[a] : cells[a] - 0.5, 0.0, top);
    base[std::size_t(a)] = std::min(long(at), long(top) - 1);
    t[a] = at - double(base[std::size_t(a)]);
  }
  double sum = 0;
  for (long corner = 0; corner < 8; ++corner) {
    const long x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
    const double w = (x ? t[0] : 1 - t[0]) * (y ? t[1] : 1 - t[1]) * (z ? t[2] : 1 - t[2]);
    sum += w * face[std::size_t(axis)][faceIndex(axis, base[0] + x, base[1] + y, base[2] + z)];
  }
  return sum;
}

Vec3 FluidWind::Impl::velocity(const Vec3& position) const {
  return {sample(0, position), sample(1, position), sample(2, position)};
}

void FluidWind::Impl::reset() {
  for (int axis = 0; axis < 3; ++axis) {
    const auto dims = faceDims(axis);
    face[std::size_t(axis)].assign(std::size_t(dims[0] * dims[1] * dims[2]), options.mean[axis]);
  }
  pressure.assign(cellCount(), 0);
}

void FluidWind::Impl::findSolids(const Context& context) {
  solid.assign(cellCount(), 0);
  if (!obstacle.distance) return;
  parallelFor(context, cellCount(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      const Vec3 at(double(long(c) % n[0]) + 0.5, double(long(c) / n[0] % n[1]) + 0.5,
                    double(long(c) / n[0] / n[1]) + 0.5);
      solid[c] = obstacle.distance(options.lo + cell * at) < 0;
    }
  });
}

void FluidWind::Impl::advect(double timeStep, const Context& context) {
  for (int axis = 0; axis < 3; ++axis) {
    auto& out = next[std::size_t(axis)];
    out.resize(face[std::size_t(axis)].size());
    forFaces(axis, context, [&](std::size_t index, const std::array<long, 3>& at) {
      const Vec3 point = facePoint(axis, at);
      const Vec3 half = point - 0.5 * timeStep * velocity(point);
      out[index] = sample(axis, point - timeStep * velocity(half));
    });
  }
  std::swap(face, next);
}

void FluidWind::Impl::splatHair(const NodeView& nodes, const Context& context) {
  hasHair = false;
  if (!(options.hairDrag > 0)) return;
  points.clear();
  values.clear();
  for (std::size_t i = 0; i < nodes.positions.size(); ++i) {
    const Vec3 &p = nodes.positions[i], &v = nodes.velocities[i];
    const bool inside =
        (p.array() >= options.lo.array()).all() &&
        ((p - options.lo).array() / cell < Vec3(double(n[0]), double(n[1]), double(n[2])).array()).all();
    if (!inside || !v.allFinite()) continue;
    const double density = nodes.masses[i] / (cell * cell * cell);
    points.push_back(p);
    values.insert(values.end(), {density, density * v[0], density * v[1], density * v[2]});
  }
  if (points.empty()) return;
  hasHair = true;
  hairFrame.origin = options.lo;
  hairFrame.cell = cell;
  hairFrame.log2Size = 3;
  while (hairFrame.size() < *std::max_element(n.begin(), n.end()) + 2) ++hairFrame.log2Size;
  splatter.splat(hairFrame, points, values, 4, hair, context);
}

/// Implicit: u ← (u + h β u_hair) / (1 + h β), β = hairDrag · hair's density.
void FluidWind::Impl::dragHair(double timeStep, const Context& context) {
  if (!hasHair) return;
  for (int axis = 0; axis < 3; ++axis) {
    forFaces(axis, context, [&](std::size_t index, const std::array<long, 3>& at) {
      const float* above = &hair[4 * hairFrame.index(at[0], at[1], at[2])];
      std::array<long, 3> under = at;
      --under[std::size_t(axis)];
      const float* below = &hair[4 * hairFrame.index(under[0], under[1], under[2])];
      const double mass = 0.5 * (double(above[0]) + double(below[0]));
      const double momentum = 0.5 * (double(above[1 + axis]) + double(below[1 + axis]));
      const double rate = timeStep * options.hairDrag;
      double& u = face[std::size_t(axis)][index];
      u = (u + rate * momentum) / (1 + rate * mass);
    });
  }
}

void FluidWind::Impl::holdSolids(const Context& context) {
  if (!obstacle.distance) return;
  for (int axis = 0; axis < 3; ++axis) {
    const long last = n[std::size_t(axis)];
    forFaces(axis, context, [&](std::size_t index, const std::array<long, 3>& at) {
      std::array<long, 3> under = at;
      --under[std::size_t(axis)];
      const bool above = at[std::size_t(axis)] < last && solid[cellIndex(at[0], at[1], at[2])];
      const bool below = under[std::size_t(axis)] >= 0 && solid[cellIndex(under[0], under[1], under[2])];
      if (above || below)
        face[std::size_t(axis)][index] = obstacle.velocity ? obstacle.velocity(facePoint(axis, at))[axis] : 0;
    });
  }
}

FluidWind::FluidWind(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
FluidWind::~FluidWind() = default;

Result<std::unique_ptr<FluidWind>> FluidWind::create(const FluidOptions& options, AirObstacle obstacle) {
  const Vec3 extents = options.hi - options.lo;
  if (!extents.allFinite() || !(extents.minCoeff() > 0) || !options.lo.allFinite())
    return makeError(ErrorCode::InvalidArgument, "the box of the air must have a finite size above 0");
  if (options.cells < 4 || options.cells > 128)
    return makeError(ErrorCode::InvalidArgument, "the air takes 4 to 128 cells along its longest side");
  if (!(options.mean.cwiseAbs().maxCoeff() < 1e100) || !(options.hairDrag >= 0 && options.hairDrag < 1e100) ||
      !(options.tolerance > 0))
    return makeError(ErrorCode::InvalidArgument, "wind, hair drag or tolerance of the air is out of range");
  auto impl = std::make_unique<Impl>();
  impl->options = options;
  impl->obstacle = std::move(obstacle);
  impl->cell = extents.maxCoeff() / options.cells;
  for (int axis = 0; axis < 3; ++axis)
    impl->n[std::size_t(axis)] = std::max(4L, long(std::ceil(extents[axis] / impl->cell - 1e-9)));
  impl->reset();
  return std::unique_ptr<FluidWind>(new FluidWind(std::move(impl)));
}

void FluidWind::prepare(const NodeView& nodes, double, double timeStep, const Context& context) {
  const Stopwatch watch;
  Impl& air = *impl_;
  air.findSolids(context);
  air.advect(timeStep, context);
  air.splatHair(nodes, context);
  air.dragHair(timeStep, context);
  air.holdSolids(context);
  air.project(context);
  bool finite = true;
  for (const auto& component : air.face)
    finite =
        finite && std::all_of(component.begin(), component.end(), [](double u) { return std::isfinite(u); });
  if (!finite) air.reset();
  air.report.seconds = watch.seconds();
}

Vec3 FluidWind::velocity(const Vec3& position) const {
  return impl_->velocity(position);
}
void FluidWind::setObstacle(AirObstacle obstacle) {
  impl_->obstacle = std::move(obstacle);
}
const FluidReport& FluidWind::report() const {
  return impl_->report;
}

std::vector<double> FluidWind::state() const {
  std::vector<double> out;
  for (const auto& component : impl_->face) out.insert(out.end(), component.begin(), component.end());
  out.insert(out.end(), impl_->pressure.begin(), impl_->pressure.end());
  return out;
}

Status FluidWind::restore(std::span<const double> state) {
  std::size_t wanted = impl_->pressure.size();
  for (const auto& component : impl_->face) wanted += component.size();
  if (state.size() != wanted)
    return makeError(ErrorCode::InvalidArgument, "the stored air does not fit the grid of this scene");
  for (auto* part : {&impl_->face[0], &impl_->face[1], &impl_->face[2], &impl_->pressure}) {
    std::copy_n(state.begin(), part->size(), part->begin());
    state = state.subspan(part->size());
  }
  return {};
}

}  // namespace coif
