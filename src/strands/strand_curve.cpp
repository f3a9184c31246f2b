#include "coif/strands/strand_curve.h"

namespace coif {

void StrandCurve::load(std::span<const Vec3f> points, const Frame& root) {
  points_.clear();
  for (const Vec3f& p : points) points_.push_back(p.cast<double>());
  frames_.resize(points_.size());
  parallelTransport(std::span<const Vec3>(points_), root, frames_);
  arcs_.assign(points_.size(), 0);
  for (std::size_t p = 1; p < points_.size(); ++p)
    arcs_[p] = arcs_[p - 1] + (points_[p] - points_[p - 1]).norm();
}

Vec3 StrandCurve::position(double place) const {
  const double beyond = place - double(size() - 1);
  if (beyond > 0) return points_.back() + beyond * lastStep() * frames_.back().tangent;
  return splineAt<Vec3>(points_, place);
}

Frame StrandCurve::frame(double place) const {
  if (place >= double(size() - 1)) return frames_.back();
  const auto before = std::size_t(std::max(place, 0.0));
  const double t = place - double(before);
  if (!(t > 0)) return frames_[before];
  // Least rotation from the nearer point's frame: the same as transport but for the third order of the step.
  const Frame& near = frames_[t < 0.5 ? before : before + 1];
  const Vec3 tangent = (1 - t) * frames_[before].tangent + t * frames_[before + 1].tangent;
  return tangent.squaredNorm() > 1e-12 ? turnedTo(near, tangent) : near;
}

double StrandCurve::arc(double place) const {
  const double beyond = place - double(size() - 1);
  if (beyond >= 0) return arcs_.back() + beyond * lastStep();
  const auto before = std::size_t(std::max(place, 0.0));
  return arcs_[before] + (place - double(before)) * (arcs_[before + 1] - arcs_[before]);
}

double StrandCurve::placeOfArc(double arc) const {
  const double tip = double(size() - 1);
  if (!(length() > 0)) return tip;
  if (arc >= length()) return lastStep() > 0 ? tip + (arc - length()) / lastStep() : tip;
  const auto after = std::size_t(std::ranges::upper_bound(arcs_, std::max(arc, 0.0)) - arcs_.begin());
  const double step = arcs_[after] - arcs_[after - 1];
  return double(after - 1) + (std::max(arc, 0.0) - arcs_[after - 1]) / step;
}

}  // namespace coif
