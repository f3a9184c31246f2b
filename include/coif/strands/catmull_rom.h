// Catmull–Rom splines as fixed linear combinations of their control points.
//
// With uniform knots a segment is ½[2P1 + (P2−P0)t + (2P0−5P1+4P2−P3)t² + (3P1−P0−3P2+P3)t³] (Catmull and Rom
// 1974); with centripetal or chordal knots it is the curve of Barry and Goldman's pyramid (SIGGRAPH 1988;
// Yuksel et al., "Parameterization and applications of Catmull–Rom curves", 2011), written as a cubic Hermite
// segment. Both are C¹. Ends are pinned: P₋₁ = 2P0 − P1 and likewise at the tip, so two points give a
// straight line.
//
// Parameters run over [0, n − 1] for n control points, one unit a segment, whatever the knots.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "coif/base/vec.h"

namespace coif {

enum class Knots { Uniform, Centripetal, Chordal };

/// Knot intervals of `lengths` (the n − 1 distances between control points): 1, √length or length. A length
/// counts as at least 1e-6 of their sum, so repeated points keep distinct knots; all zero: uniform.
std::vector<double> knotIntervals(std::span<const double> lengths, Knots knots);
/// The same from the control points themselves.
std::vector<double> knotIntervals(std::span<const Vec3> points, Knots knots);

/// Weights of the n control points at a parameter in [0, n − 1]; n − 1 knot intervals, all > 0, n >= 2; out
/// has n elements, at most four of them not zero. At the ends exactly the end point.
void splineWeights(std::span<const double> intervals, double parameter, std::span<double> out);

/// Rows of weights: row p of a table of R rows and n columns holds the weights of parameters[p].
class SplineTable {
 public:
  SplineTable(std::span<const double> intervals, std::span<const double> parameters);
  std::size_t rows() const { return rows_; }
  std::size_t columns() const { return columns_; }
  std::span<const double> row(std::size_t p) const {
    return std::span(weights_).subspan(p * columns_, columns_);
  }

 private:
  std::size_t rows_, columns_;
  std::vector<double> weights_;
};

/// `count` >= 2 parameters evenly over [0, segments].
std::vector<double> evenParameters(std::uint32_t segments, std::size_t count);
/// Parameters of segments cut into pieces[k] >= 1 even pieces each: 1 + Σ pieces.
std::vector<double> pieceParameters(std::span<const std::uint32_t> pieces);

/// P″ at both ends of segment k (it is linear between), by the segment's own parameter.
std::array<Vec3, 2> secondDerivatives(std::span<const Vec3> points, std::span<const double> intervals,
                                      std::size_t segment);
/// Pieces that keep the chord error of a segment below `tolerance`: ⌈√(bound/(8·tolerance))⌉, at least 1,
/// with `bound` the greatest |P″| of the segment. At most 2^20.
std::uint32_t chordPieces(double bound, double tolerance);

/// Points of the spline at `samples` >= 2 even parameters, first and last control point included exactly; >=
/// 1 control point (a single one is repeated). In double.
std::vector<Vec3> catmullRom(std::span<const Vec3> points, std::size_t samples, Knots knots = Knots::Uniform);

}  // namespace coif
