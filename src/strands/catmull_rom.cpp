#include "coif/strands/catmull_rom.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "coif/base/check.h"

namespace coif {
namespace {

constexpr double kLeastKnot = 1e-6;      // of the curve's length
constexpr double kMostPieces = 1 << 20;  // a segment

/// Weights of P(k−1), P(k), P(k+1), P(k+2) in a quantity of segment k.
using Four = std::array<double, 4>;

/// The neighbouring knot intervals of segment k; a pinned end repeats its own.
struct Intervals {
  double before, own, after;
};
Intervals around(std::span<const double> intervals, std::size_t k) {
  return {k > 0 ? intervals[k - 1] : intervals[k], intervals[k],
          k + 1 < intervals.size() ? intervals[k + 1] : intervals[k]};
}

/// dP/du at the start (P(k)) of a segment, u running 0…1 over it: own·[(P1−P0)/before − (P2−P0)/(before+own)
/// + (P2−P1)/own].
Four startTangent(const Intervals& d) {
  const double a = d.own / d.before, b = d.own / (d.before + d.own);
  return {b - a, a - 1, 1 - b, 0};
}
Four endTangent(const Intervals& d) {
  const double a = d.own / d.after, b = d.own / (d.own + d.after);
  return {0, b - 1, 1 - a, a - b};
}

Four combine(const Four& m0, double w0, const Four& m1, double w1, double p1, double p2) {
  Four out;
  for (int i = 0; i < 4; ++i) out[i] = w0 * m0[i] + w1 * m1[i];
  out[1] += p1;
  out[2] += p2;
  return out;
}

/// Adds the four weights to the n control points, the phantom ends by their rule P₋₁ = 2P0 − P1.
template <class Add>
void fold(const Four& four, std::size_t k, std::size_t n, Add add) {
  const auto one = [&](std::ptrdiff_t index, double weight) {
    if (weight == 0) return;
    if (index < 0) {
      add(0, 2 * weight);
      add(1, -weight);
    } else if (index >= std::ptrdiff_t(n)) {
      add(n - 1, 2 * weight);
      add(n - 2, -weight);
    } else {
      add(std::size_t(index), weight);
    }
  };
  for (int i = 0; i < 4; ++i) one(std::ptrdiff_t(k) + i - 1, four[i]);
}

}  // namespace

std::vector<double> knotIntervals(std::span<const double> lengths, Knots knots) {
  std::vector<double> out(lengths.size(), 1.0);
  const double total = std::accumulate(lengths.begin(), lengths.end(), 0.0);
  if (knots == Knots::Uniform || !(total > 0)) return out;
  for (std::size_t k = 0; k < out.size(); ++k) {
    const double length = std::max(lengths[k] / total, kLeastKnot);  // only ratios matter
    out[k] = knots == Knots::Chordal ? length : std::sqrt(length);
  }
  return out;
}

std::vector<double> knotIntervals(std::span<const Vec3> points, Knots knots) {
  std::vector<double> lengths;
  for (std::size_t k = 0; k + 1 < points.size(); ++k) lengths.push_back((points[k + 1] - points[k]).norm());
  return knotIntervals(lengths, knots);
}

void splineWeights(std::span<const double> intervals, double parameter, std::span<double> out) {
  const std::size_t segments = intervals.size();
  COIF_CHECK(segments >= 1 && out.size() == segments + 1, "a weight for each of at least two control points");
  const auto k = std::size_t(std::clamp(std::floor(parameter), 0.0, double(segments - 1)));
  const double u = std::clamp(parameter - double(k), 0.0, 1.0);
  const Intervals d = around(intervals, k);
  const double h1 = u * u * (3 - 2 * u), g0 = u * (1 - u) * (1 - u),
               g1 = u * u * (u - 1);  // cubic Hermite basis
  std::fill(out.begin(), out.end(), 0.0);
  fold(combine(startTangent(d), g0, endTangent(d), g1, 1 - h1, h1), k, out.size(),
       [&](std::size_t i, double weight) { out[i] += weight; });
}

SplineTable::SplineTable(std::span<const double> intervals, std::span<const double> parameters)
    : rows_(parameters.size()), columns_(intervals.size() + 1), weights_(rows_ * columns_) {
  for (std::size_t p = 0; p < rows_; ++p) {
    splineWeights(intervals, parameters[p], std::span(weights_).subspan(p * columns_, columns_));
  }
}

std::vector<double> evenParameters(std::uint32_t segments, std::size_t count) {
  COIF_CHECK(count >= 2, "a curve has two ends");
  std::vector<double> out(count);
  for (std::size_t p = 0; p < count; ++p) out[p] = double(segments) * double(p) / double(count - 1);
  return out;
}

std::vector<double> pieceParameters(std::span<const std::uint32_t> pieces) {
  std::vector<double> out;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    for (std::uint32_t i = 0; i < pieces[k]; ++i) out.push_back(double(k) + double(i) / double(pieces[k]));
  }
  out.push_back(double(pieces.size()));
  return out;
}

std::array<Vec3, 2> secondDerivatives(std::span<const Vec3> points, std::span<const double> intervals,
                                      std::size_t segment) {
  const Intervals d = around(intervals, segment);
  const Four m0 = startTangent(d), m1 = endTangent(d);
  std::array<Vec3, 2> out{Vec3::Zero(), Vec3::Zero()};
  // Hermite: P″(0) = −6P1 + 6P2 − 4m0 − 2m1, P″(1) = 6P1 − 6P2 + 2m0 + 4m1.
  const std::array<Four, 2> weights{combine(m0, -4, m1, -2, -6, 6), combine(m0, 2, m1, 4, 6, -6)};
  for (int end = 0; end < 2; ++end) {
    fold(weights[end], segment, points.size(),
         [&](std::size_t i, double weight) { out[end] += weight * points[i]; });
  }
  return out;
}

std::uint32_t chordPieces(double bound, double tolerance) {
  const double pieces = std::ceil(std::sqrt(bound / (8 * tolerance)));
  return std::uint32_t(std::clamp(pieces, 1.0, kMostPieces));
}

std::vector<Vec3> catmullRom(std::span<const Vec3> points, std::size_t samples, Knots knots) {
  COIF_CHECK(!points.empty() && samples >= 2, "a spline needs a control point and two samples");
  if (points.size() == 1) return std::vector<Vec3>(samples, points[0]);
  const SplineTable table(knotIntervals(points, knots),
                          evenParameters(std::uint32_t(points.size() - 1), samples));
  std::vector<Vec3> out(samples, Vec3::Zero());
  for (std::size_t p = 0; p < samples; ++p) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (table.row(p)[i] != 0) out[p] += table.row(p)[i] * points[i];
    }
  }
  return out;
}

}  // namespace coif
