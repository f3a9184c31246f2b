// Stable fluids on a staggered grid with porous hair and a solid head.
#include <algorithm>
#include <array>
#include <cmath>

#include "coif/base/parallel.h"
#include "coif/base/report.h"
#include "coif/simulate/air.h"

namespace coif {

namespace {
constexpr std::size_t kGrain = 512;
}

struct FluidWind::Impl {
  FluidOptions options;
  AirObstacle obstacle;
  std::array<long, 3> n{};  ///< cells
  double cell = 1;
  std::array<std::vector<double>, 3> face, next;  ///< velocity components on the faces across each axis
  std::vector<double> pressure, residual, direction, product, diagonal, divergence;
  std::vector<std::uint8_t> solid;  ///< by cell
  PointSplatter splatter;
  std::vector<Vec3> points;
  std::vector<double> values;
  std::vector<float> hair;  ///< mass and momentum densities
  GridFrame hairFrame;
  bool hasHair = false;
  FluidReport report;

  std::size_t cellCount() const { return std::size_t(n[0] * n[1] * n[2]); }
  std::size_t cellIndex(long i, long j, long k) const { return std::size_t((k * n[1] + j) * n[0] + i); }
  std::array<long, 3> faceDims(int axis) const {
    std::array<long, 3> dims = n;
    ++dims[std::size_t(axis)];
    return dims;
  }
  std::size_t faceIndex(int axis, long i, long j, long k) const {
    const auto dims = faceDims(axis);
    return std::size_t((k * dims[1] + j) * dims[0] + i);
  }
  Vec3 facePoint(int axis, const std::array<long, 3>& at) const {
    Vec3 offset = Vec3::Constant(0.5);
    offset[axis] = 0;
    return options.lo + cell * (Vec3(double(at[0]), double(at[1]), double(at[2])) + offset);
  }

  double sample(int axis, const Vec3& position) const;
  Vec3 velocity(const Vec3& position) const;
  template <class Body>
  void forFaces(int axis, const Context& context, Body&& body) const;
  void reset();
  void findSolids(const Context& context);
  void advect(double timeStep, const Context& context);
  void splatHair(const NodeView& nodes, const Context& context);
  void dragHair(double timeStep, const Context& context);
  void holdSolids(const Context& context);
  void project(const Context& context);
  double measure(const Context& context);
  void applyMatrix(const std::vector<double>& in, std::vector<double>& out, const Context& context) const;
  double dot(const std::vector<double>& a, const std::vector<double>& b, const Context& context) const;
  template <class Visit>
  void forNeighbours(long i, long j, long k, Visit&& visit) const;
};

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

/// body(index, at) for every face across `axis`.
template <class Body>
void FluidWind::Impl::forFaces(int axis, const Context& context, Body&& body) const {
  const auto dims = faceDims(axis);
  parallelFor(context, std::size_t(dims[1] * dims[2]), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      const long j = long(row) % dims[1], k = long(row) / dims[1];
      for (long i = 0; i < dims[0]; ++i) body(faceIndex(axis, i, j, k), std::array<long, 3>{i, j, k});
    }
  });
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

/// visit(neighbour cell or -1 outside) for the neighbours that are no solid.
template <class Visit>
void FluidWind::Impl::forNeighbours(long i, long j, long k, Visit&& visit) const {
  const std::array<long, 3> at{i, j, k};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (long side = -1; side <= 1; side += 2) {
      std::array<long, 3> other = at;
      other[axis] += side;
      if (other[axis] < 0 || other[axis] >= n[axis]) {
        visit(-1L);
      } else if (const auto c = cellIndex(other[0], other[1], other[2]); !solid[c]) {
        visit(long(c));
      }
    }
  }
}

void FluidWind::Impl::applyMatrix(const std::vector<double>& in, std::vector<double>& out,
                                  const Context& context) const {
  parallelFor(context, std::size_t(n[1] * n[2]), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      const long j = long(row) % n[1], k = long(row) / n[1];
      for (long i = 0; i < n[0]; ++i) {
        const std::size_t c = cellIndex(i, j, k);
        double sum = diagonal[c] * in[c];
        if (!solid[c])
          forNeighbours(i, j, k, [&](long other) { sum -= other >= 0 ? in[std::size_t(other)] : 0; });
        out[c] = sum;
      }
    }
  });
}

double FluidWind::Impl::dot(const std::vector<double>& a, const std::vector<double>& b,
                            const Context& context) const {
  return parallelSum(context, a.size(), 4096, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += a[i] * b[i];
    return sum;
  });
}

/// Divergence × cell of every fluid cell into `divergence`; returns the greatest.
double FluidWind::Impl::measure(const Context&) {
  double worst = 0;
  for (long k = 0; k < n[2]; ++k) {
    for (long j = 0; j < n[1]; ++j) {
      for (long i = 0; i < n[0]; ++i) {
        const std::size_t c = cellIndex(i, j, k);
        divergence[c] = 0;
        if (solid[c] || diagonal[c] == 0) continue;
        divergence[c] = face[0][faceIndex(0, i + 1, j, k)] - face[0][faceIndex(0, i, j, k)] +
                        face[1][faceIndex(1, i, j + 1, k)] - face[1][faceIndex(1, i, j, k)] +
                        face[2][faceIndex(2, i, j, k + 1)] - face[2][faceIndex(2, i, j, k)];
        worst = std::max(worst, std::abs(divergence[c]));
      }
    }
  }
  return worst;
}

/// −∇²p = −∇·u by conjugate gradients with the diagonal as preconditioner, from the last step's pressure.
void FluidWind::Impl::project(const Context& context) {
  const std::size_t count = cellCount();
  diagonal.assign(count, 0);
  divergence.resize(count);
  product.resize(count);
  for (std::size_t c = 0; c < count; ++c) {
    if (solid[c]) continue;
    forNeighbours(long(c) % n[0], long(c) / n[0] % n[1], long(c) / n[0] / n[1],
                  [&](long) { diagonal[c] += 1; });
  }
  for (std::size_t c = 0; c < count; ++c) {
    if (diagonal[c] == 0) pressure[c] = 0;
  }
  double speed = 0;
  for (const auto& component : face) {
    for (const double u : component) speed = std::max(speed, std::abs(u));
  }
  report.iterations = 0;
  measure(context);
  const double wanted = options.tolerance * speed;
  applyMatrix(pressure, product, context);
  residual.resize(count);
  for (std::size_t c = 0; c < count; ++c) residual[c] = diagonal[c] > 0 ? -divergence[c] - product[c] : 0;
  const auto preconditioned = [&](std::size_t c) { return diagonal[c] > 0 ? residual[c] / diagonal[c] : 0; };
  const auto worst = [&] {
    double most = 0;
    for (const double r : residual) most = std::max(most, std::abs(r));
    return most;
  };
  direction.resize(count);
  std::vector<double>& z = next[0];  // free until the next advection
  z.resize(count);
  for (std::size_t c = 0; c < count; ++c) direction[c] = z[c] = preconditioned(c);
  double rz = dot(residual, z, context);
  while (report.iterations < options.maxIterations && worst() > wanted && rz > 0) {
    applyMatrix(direction, product, context);
    const double curvature = dot(direction, product, context);
    if (!(curvature > 0)) break;
    const double step = rz / curvature;
    for (std::size_t c = 0; c < count; ++c) {
      pressure[c] += step * direction[c];
      residual[c] -= step * product[c];
      z[c] = preconditioned(c);
    }
    const double fresh = dot(residual, z, context);
    for (std::size_t c = 0; c < count; ++c) direction[c] = z[c] + fresh / rz * direction[c];
    rz = fresh;
    ++report.iterations;
  }
  for (int axis = 0; axis < 3; ++axis) {
    const long last = n[std::size_t(axis)];
    forFaces(axis, context, [&](std::size_t index, const std::array<long, 3>& at) {
      std::array<long, 3> under = at;
      --under[std::size_t(axis)];
      const bool top = at[std::size_t(axis)] >= last, bottom = under[std::size_t(axis)] < 0;
      const std::size_t above = top ? 0 : cellIndex(at[0], at[1], at[2]);
      const std::size_t below = bottom ? 0 : cellIndex(under[0], under[1], under[2]);
      if ((!top && solid[above]) || (!bottom && solid[below])) return;
      face[std::size_t(axis)][index] -= (top ? 0 : pressure[above]) - (bottom ? 0 : pressure[below]);
    });
  }
  report.divergence = speed > 0 ? measure(context) / speed : 0;
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
