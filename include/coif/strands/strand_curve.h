// A strand's curve as the mesh has it: its points, and between them the spline through them, with frames.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "coif/strands/frames.h"

namespace coif {

/// Uniform Catmull–Rom with pinned ends through `values` at a place in [0, n − 1]; exactly a value at a whole
/// place. Beyond the ends: the end value. Type T: a vector or a number.
template <class T>
T splineAt(std::span<const T> values, double place) {
  const std::size_t last = values.size() - 1;
  if (!(place > 0) || last == 0) return values[0];
  if (place >= double(last)) return values[last];
  const auto i = std::size_t(place);
  const double t = place - double(i);
  const T &b = values[i], &c = values[i + 1];
  if (t == 0) return b;
  const T a = i > 0 ? values[i - 1] : T(2 * b - c), d = i + 2 <= last ? values[i + 2] : T(2 * c - b);
  return b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)));
}

class StrandCurve {
 public:
  /// At least one point. `root`: frame at the first point; it is turned to the curve's first tangent.
  void load(std::span<const Vec3f> points, const Frame& root);

  std::size_t size() const { return points_.size(); }
  std::span<const Vec3> points() const { return points_; }
  double length() const { return arcs_.back(); }  ///< of the polyline

  // At a place in points: 0 at the root, size() − 1 at the tip; beyond it the curve goes straight on.
  Vec3 position(double place) const;
  Frame frame(double place) const;
  double arc(double place) const;
  /// The place where so much of the polyline lies behind, >= 0; beyond the tip at its last step's pace. The
  /// tip of a curve of no length.
  double placeOfArc(double arc) const;

 private:
  double lastStep() const { return arcs_.size() > 1 ? arcs_.back() - arcs_[arcs_.size() - 2] : 0; }
  std::vector<Vec3> points_;
  std::vector<Frame> frames_;
  std::vector<double> arcs_;
};

}  // namespace coif
