#include "coif/style/ramp.h"

#include <algorithm>
#include <cmath>

namespace coif {

Status validate(const Ramp& ramp) {
  const auto refuse = [](std::string why) { return makeError(ErrorCode::InvalidArgument, std::move(why)); };
  if (ramp.points.empty()) return refuse("a ramp needs a point");
  if (ramp.points.size() > Ramp::kMostPoints)
    return refuse("a ramp has at most " + std::to_string(Ramp::kMostPoints) + " points");
  double before = -1;
  for (const RampPoint& p : ramp.points) {
    if (!(p.x >= 0 && p.x <= 1 && p.y >= 0 && p.y <= 1))
      return refuse("a ramp's points lie between 0 and 1 in both directions");
    if (!(p.x > before)) return refuse("a ramp's points ascend from root to tip");
    before = p.x;
  }
  return {};
}

RampCurve::RampCurve(Ramp ramp) : ramp_(std::move(ramp)) {
  const auto& p = ramp_.points;
  if (ramp_.shape == RampShape::Linear || p.size() < 2) return;
  const std::size_t n = p.size();
  std::vector<double> chord(n - 1);
  for (std::size_t i = 0; i + 1 < n; ++i) chord[i] = (p[i + 1].y - p[i].y) / (p[i + 1].x - p[i].x);
  slopes_.resize(n);
  slopes_[0] = chord[0], slopes_[n - 1] = chord[n - 2];
  for (std::size_t i = 1; i + 1 < n; ++i) slopes_[i] = 0.5 * (chord[i - 1] + chord[i]);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    if (chord[i - 1] * chord[i] <= 0) slopes_[i] = 0;  // a peak, a trough or a level stretch
  }
  for (std::size_t i = 0; i + 1 < n; ++i) {
    if (chord[i] == 0) {
      slopes_[i] = slopes_[i + 1] = 0;
      continue;
    }
    // Within the circle of radius 3 the cubic is monotone (their section 4).
    const double a = slopes_[i] / chord[i], b = slopes_[i + 1] / chord[i], length = std::hypot(a, b);
    if (length > 3) slopes_[i] = 3 / length * a * chord[i], slopes_[i + 1] = 3 / length * b * chord[i];
  }
}

double RampCurve::operator()(double x) const {
  const auto& p = ramp_.points;
  if (!(x > p.front().x)) return p.front().y;
  if (!(x < p.back().x)) return p.back().y;
  std::size_t i = 0;
  while (x >= p[i + 1].x) ++i;
  const double h = p[i + 1].x - p[i].x, t = (x - p[i].x) / h;
  if (slopes_.empty()) return p[i].y + t * (p[i + 1].y - p[i].y);
  const double s = 1 - t;
  const double y = s * s * (1 + 2 * t) * p[i].y + t * t * (1 + 2 * s) * p[i + 1].y +
                   h * t * s * (s * slopes_[i] - t * slopes_[i + 1]);
  return std::clamp(y, std::min(p[i].y, p[i + 1].y), std::max(p[i].y, p[i + 1].y));  // against rounding
}

double RampCurve::greatest() const {
  return std::ranges::max(ramp_.points, {}, &RampPoint::y).y;  // no cubic overshoots
}

}  // namespace coif
