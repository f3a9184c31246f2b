#include "place/cg.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace coif::placing {

namespace {

// Quotient where the divisor is positive, else 0: a column that is solved stands still.
Sums quotient(const Sums& a, const Sums& b) {
  return (b > 0).select(a / (b > 0).select(b, 1.0), 0.0);
}

constexpr int kCheckEvery = 10;

}  // namespace

CgOutcome conjugateGradients(const PlaceSystem& system, const Preconditioner& m, const BoxInverse& box,
                             double target, int maxIterations, Block& delta, Block& r,
                             const Context& context) {
  CgOutcome outcome;
  const bool bounding = &m == &box;
  Block z, p, q(r.rows(), r.cols());
  m.apply(r, z, context);
  system.removeMeans(z);
  p = z;
  Sums rz = dots(r, z, context);
  Eigen::Index watched = 0;
  rz.maxCoeff(&watched);
  const double start = bounding ? box.errorBound(rz) : box.errorBound(r, context);
  double bound = start;
  while (bound > target && outcome.iterations < maxIterations) {
    if (context.cancelled()) {
      outcome.cancelled = true;
      return outcome;
    }
    multiply(system.matrix(), p, q, context);
    const Sums alpha = quotient(rz, dots(p, q, context));
    if (!(alpha > 0).any()) break;
    addScaled(delta, p, alpha, context);
    addScaled(r, q, -alpha, context);
    m.apply(r, z, context);
    system.removeMeans(z);
    const Sums next = dots(r, z, context);
    const Sums beta = quotient(next, rz);
    scaleAndAdd(p, z, beta, context);
    rz = next;
    ++outcome.iterations;
    if (alpha[watched] > 0) {
      outcome.alpha.push_back(alpha[watched]);
      outcome.beta.push_back(beta[watched]);
    }
    if (bounding) {
      bound = box.errorBound(rz);
    } else if (outcome.iterations % kCheckEvery == 0) {
      bound = box.errorBound(r, context);
    }
    if (!(rz > 0).any()) break;
    const double way = std::log(std::max(start / target, 1.0 + 1e-12));
    context.report("place", std::clamp(std::log(start / bound) / way, 0.0, 1.0));
  }
  return outcome;
}

namespace {

// Eigenvalues below x of the symmetric tridiagonal matrix (Sturm sequence).
std::size_t countBelow(const std::vector<double>& diagonal, const std::vector<double>& off2, double x) {
  std::size_t count = 0;
  double d = 1;
  for (std::size_t i = 0; i < diagonal.size(); ++i) {
    d = diagonal[i] - x - (i > 0 ? off2[i - 1] / d : 0.0);
    if (d == 0) d = 1e-300;
    if (d < 0) ++count;
  }
  return count;
}

}  // namespace

double ritzCondition(const CgOutcome& outcome) {
  const std::size_t n = outcome.alpha.size();
  if (n == 0) return 0;
  std::vector<double> diagonal(n), off2(n, 0);
  double high = 0;
  for (std::size_t j = 0; j < n; ++j) {
    diagonal[j] = 1 / outcome.alpha[j] + (j > 0 ? outcome.beta[j - 1] / outcome.alpha[j - 1] : 0.0);
    off2[j] = outcome.beta[j] / (outcome.alpha[j] * outcome.alpha[j]);
    high = std::max(high, diagonal[j] + 2 * std::sqrt(off2[j]) + (j > 0 ? 2 * std::sqrt(off2[j - 1]) : 0.0));
  }
  const auto eigenvalue =
      [&](std::size_t index) {  // bisection in the logarithm: the small one needs digits too
        double low = high * 1e-18, top = high;
        for (int i = 0; i < 100; ++i) {
          const double middle = std::sqrt(low * top);
          (countBelow(diagonal, off2, middle) > index ? top : low) = middle;
        }
        return std::sqrt(low * top);
      };
  return eigenvalue(n - 1) / eigenvalue(0);
}

}  // namespace coif::placing
