// A curve from root to tip: how much of an effect a hair takes where.
#pragma once

#include <span>
#include <vector>

#include "coif/base/result.h"

namespace coif {

enum class RampShape { Linear, Smooth };

struct RampPoint {
  double x = 0;  ///< 0 at the root, 1 at the tip
  double y = 0;  ///< 0 … 1
  bool operator==(const RampPoint&) const = default;
};

/// Before the first point and after the last the curve is level.
struct Ramp {
  static constexpr std::size_t kMostPoints = 64;

  std::vector<RampPoint> points{{0, 1}};
  RampShape shape = RampShape::Smooth;
  bool operator==(const Ramp&) const = default;
};

/// Refuses no point, more than kMostPoints, places that do not ascend within [0, 1], values outside [0, 1].
Status validate(const Ramp& ramp);

/// A ramp made ready to be asked. Linear: straight between points. Smooth: the cubic Hermite curve whose
/// tangents are those of Fritsch and Carlson ("Monotone piecewise cubic interpolation", SIAM J. Numer. Anal.
/// 17, 1980): through every point, C¹, and never above or below its neighbouring points.
class RampCurve {
 public:
  RampCurve() : RampCurve(Ramp{}) {}
  explicit RampCurve(Ramp ramp);  ///< must validate
  double operator()(double x) const;
  double greatest() const;  ///< that it takes anywhere

 private:
  Ramp ramp_;
  std::vector<double> slopes_;  // at the points, of the smooth shape
};

}  // namespace coif
