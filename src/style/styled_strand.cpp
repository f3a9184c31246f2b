#include "style/styled_strand.h"

namespace coif::style {
namespace {
constexpr double kLeastReach = 1e-3;  // a strand that is cut off whole keeps its id and a stub in the skin
}

void StyledStrand::load(const StrandCurve& curve, double reach, std::span<const Vec3f> offsets,
                        std::span<const float> widths) {
  curve_ = &curve;
  reach_ = reach;
  offsets_.clear();
  for (const Vec3f& o : offsets) offsets_.push_back(o.cast<double>());
  widths_.assign(curve.size(), 1.0);
  std::ranges::copy(widths, widths_.begin());
  spread();
}

void StyledStrand::spread() {
  const std::size_t n = curve_->size();
  base_.resize(n), frames_.resize(n), arcs_.resize(n);
  for (std::size_t p = 0; p < n; ++p) {
    const double at = double(p) * reach_;
    base_[p] = curve_->position(at), frames_[p] = curve_->frame(at), arcs_[p] = curve_->arc(at);
  }
}

double StyledStrand::fraction(std::size_t p) const {
  if (arcs_.back() > 0) return arcs_[p] / arcs_.back();
  return size() > 1 ? double(p) / double(size() - 1) : 0;
}

Vec3 StyledStrand::positionAt(double at) const {
  const Vec3 offset = splineAt<Vec3>(offsets_, at);
  return styledPoint(*curve_, at * reach_, offset);
}

void StyledStrand::endAt(double tip) {
  const std::size_t n = size();
  if (n < 2) return;
  const double factor = std::max(tip / double(n - 1), kLeastReach / reach_);
  if (factor == 1) return;
  std::vector<Vec3> offsets(n);
  std::vector<double> widths(n);
  for (std::size_t p = 0; p < n; ++p) {
    offsets[p] = splineAt<Vec3>(offsets_, double(p) * factor);
    widths[p] = splineAt<double>(widths_, double(p) * factor);
  }
  offsets_ = std::move(offsets), widths_ = std::move(widths);
  reach_ *= factor;
  spread();
}

void StyledStrand::endAtArc(double arc) {
  endAt(curve_->placeOfArc(arc) / reach_);
}

}  // namespace coif::style
