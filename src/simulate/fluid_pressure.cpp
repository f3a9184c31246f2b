// The pressure that leaves the air without divergence.
#include "simulate/fluid_impl.h"

namespace coif {

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

}  // namespace coif
