// Mean value coordinates of a point in a polygon.
//
// λ = w / Σw with w_i = (tan(α_{i−1}/2) + tan(α_i/2)) / r_i (Floater, "Mean value coordinates", CAGD 20,
// 2003, eq. 2.1). tan(α/2) is taken from dot and cross products by whichever of two exact formulas does not
// cancel, so the result is accurate next to edges and corners too. Concave polygons are legal and may give
// negative weights.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "coif/base/vec.h"

namespace coif {

enum class MeanValueCase {
  General,     ///< the formula
  Edge,        ///< the point is on an edge: linear there, zero elsewhere
  Corner,      ///< the point is a corner
  Degenerate,  ///< no weights exist (a point polygon): out is 1/n
};

/// Square root and finiteness for the number type of meanValueWeights; specialise for others than the
/// standard ones.
template <class T>
struct MeanValueMath {
  static T sqrt(T value) { return std::sqrt(value); }
  static bool isFinite(T value) { return std::isfinite(value); }
};

/// The kernel, for any floating type. xy: n corners as x, y pairs in order (either direction), n >= 3; out: n
/// weights. Lengths are scaled by a power of two near the polygon's extent, so no size over- or underflows.
/// Accuracy for a point inside: max |λ − exact| <= 1e-13 (double), 1e-6 (float), tested against 50-digit
/// values. Cost: one pass, n square roots, no memory.
template <class T>
MeanValueCase meanValueWeights(const T* xy, std::size_t n, T x, T y, T* out);

/// Weights of `point` in `polygon` (>= 3 corners; out as long). Reports which case held.
MeanValueCase meanValueCoordinates(std::span<const Vec2> polygon, const Vec2& point, std::span<double> out);
MeanValueCase meanValueCoordinates(std::span<const Vec2f> polygon, const Vec2f& point, std::span<float> out);

/// The same for a polygon in space: polygon and point are first laid down in the polygon's Newell plane.
/// A polygon without an area is Degenerate.
MeanValueCase meanValueCoordinates(std::span<const Vec3> polygon, const Vec3& point, std::span<double> out);
MeanValueCase meanValueCoordinates(std::span<const Vec3f> polygon, const Vec3f& point, std::span<float> out);

namespace mean_value_detail {

/// 2^-e with 2^e near the greatest corner distance along an axis; 0 when all corners and the point coincide.
template <class T>
T inverseExtent(const T* xy, std::size_t n, T x, T y) {
  T extent = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const T dx = xy[2 * i] - x, dy = xy[2 * i + 1] - y;
    extent = std::max(extent, std::max(dx < 0 ? -dx : dx, dy < 0 ? -dy : dy));
  }
  const auto approximate = static_cast<long double>(extent);
  if (!(approximate > 0) || !std::isfinite(approximate)) return 0;
  return static_cast<T>(std::ldexp(1.0L, -std::ilogb(approximate)));
}

/// Everything on the edge (or corner) nearest to the point.
template <class T>
MeanValueCase onNearestEdge(const T* xy, std::size_t n, T x, T y, T* out) {
  std::size_t best = 0;
  T bestT = 0, bestDistance = -1;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t j = i + 1 == n ? 0 : i + 1;
    const T ex = xy[2 * j] - xy[2 * i], ey = xy[2 * j + 1] - xy[2 * i + 1];
    const T px = x - xy[2 * i], py = y - xy[2 * i + 1];
    const T length2 = ex * ex + ey * ey;
    T t = length2 > 0 ? (px * ex + py * ey) / length2 : T(0);
    t = t < 0 ? T(0) : (t > 1 ? T(1) : t);
    const T dx = px - t * ex, dy = py - t * ey, distance = dx * dx + dy * dy;
    if (bestDistance < 0 || distance < bestDistance) best = i, bestT = t, bestDistance = distance;
  }
  for (std::size_t i = 0; i < n; ++i) out[i] = 0;
  out[best] = 1 - bestT;
  out[best + 1 == n ? 0 : best + 1] = bestT;
  return MeanValueCase::Edge;
}

}  // namespace mean_value_detail

template <class T>
MeanValueCase meanValueWeights(const T* xy, std::size_t n, T x, T y, T* out) {
  const T scale = mean_value_detail::inverseExtent(xy, n, x, y);
  for (std::size_t i = 0; i < n; ++i) out[i] = scale > 0 ? T(0) : T(1) / T(n);
  if (!(scale > 0)) return MeanValueCase::Degenerate;

  T ax = (xy[2 * n - 2] - x) * scale, ay = (xy[2 * n - 1] - y) * scale;  // s_i, from the last corner on
  T ra = MeanValueMath<T>::sqrt(ax * ax + ay * ay);
  std::size_t previous = n - 1;
  for (std::size_t i = 0; i < n; previous = i++) {
    const T bx = (xy[2 * i] - x) * scale, by = (xy[2 * i + 1] - y) * scale;
    const T rb = MeanValueMath<T>::sqrt(bx * bx + by * by);
    if (!(rb > 0)) {
      for (std::size_t k = 0; k < n; ++k) out[k] = T(k == i);
      return MeanValueCase::Corner;
    }
    if (ra > 0) {  // else the last corner, met when i reaches it
      const T dot = ax * bx + ay * by, cross = ax * by - ay * bx, product = ra * rb;
      if (cross == 0 && dot <= 0) {
        for (std::size_t k = 0; k < n; ++k) out[k] = 0;
        out[previous] = rb / (ra + rb);
        out[i] = ra / (ra + rb);
        return MeanValueCase::Edge;
      }
      const T tangent = dot > 0 ? cross / (product + dot) : (product - dot) / cross;
      out[previous] += tangent / ra;
      out[i] += tangent / rb;
    }
    ax = bx, ay = by, ra = rb;
  }
  T sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += out[i];
  // Σw = 0 needs a point outside; infinite needs an edge or corner nearer than the number type resolves.
  if (!MeanValueMath<T>::isFinite(sum) || sum == 0) {
    return mean_value_detail::onNearestEdge(xy, n, x, y, out);
  }
  for (std::size_t i = 0; i < n; ++i) out[i] /= sum;
  return MeanValueCase::General;
}

}  // namespace coif
