// Strands rasterised as a light (or a camera) sees them: the one rule that every map on the CPU and the GPU
// keeps.
//
// As OpenGL draws a line of width 1: one fragment per step along the segment's major axis, at the texel's
// centre, in the nearest texel across it. Centres in [min, max) of the major axis, so that a joint of a
// poly-line is counted once; equal extents count as x-major. A hair narrower than a texel covers
//   α = opacity · (width / texel width at that depth) · √(1 + m²),   m = minor / major slope on the map,
// of it, so that the coverage summed over the fragments is width · projected length / texel², clamped to
// 1 − 2⁻²⁴; its optical depth is β = −log1p(−α). Depth and width are linear along the segment in space
// (perspective-correct on the map). Segments are cut where they come nearer to a point light than
// kNearFraction of its depth range; fragments without coverage are left out.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "coif/base/context.h"
#include "coif/base/parallel.h"
#include "coif/base/result.h"
#include "coif/light/light_view.h"
#include "coif/strands/strand_set.h"

namespace coif {

class OpaqueMap;

inline constexpr double kNearFraction = 1e-4;
inline constexpr float kGreatestAlpha = 1.0f - 0x1p-24f;

/// β of a coverage; 0 … 16.64.
inline float opticalDepthOf(float alpha) {
  return -std::log1p(-std::clamp(alpha, 0.0f, kGreatestAlpha));
}

struct FragmentOptions {
  double opacity = 1;       ///< of a hair, in [0, 1]; times 1 − transparency where the strands have one
  double widthScale = 1;    ///< > 1 when fewer strands stand for all
  double defaultWidth = 0;  ///< where the strands have no widths, scene units; 0: 0.08 mm by metersPerUnit
  const OpaqueMap* opaque = nullptr;  ///< same view; fragments behind it are left out
};

struct Fragment {
  std::uint32_t texel = 0;  ///< y · size + x
  float depth = 0;          ///< LightView's
  float alpha = 0;          ///< (0, 1 − 2⁻²⁴]
  float along = 0;          ///< [0, 1]: on the segment from `point` to `point` + 1
  std::uint32_t point = 0;  ///< first point of the segment
  float beta() const { return opticalDepthOf(alpha); }
};

/// Texels a side for a map that sees the box: about ten hair's widths each (of the median point), so that a
/// texel is a mean over hairs; 16 … most.
int suggestedMapSize(const StrandSet& strands, const Box& box, int most = 512);

/// A segment as it lies on the map.
struct MapSegment {
  Vec3 a = Vec3::Zero(), b = Vec3::Zero();  ///< LightView::project of the ends, after cutting
  double from = 0, to = 1;                  ///< where the ends lie on the segment
  bool perspective = false;

  /// Cuts and projects; false when nothing is in front of the light.
  bool set(const LightView& view, const Vec3& worldA, const Vec3& worldB);

  /// emit(x, y, depth, along, √(1 + m²)) for every fragment in columns [0, size), rows [rowBegin, rowEnd).
  template <class Emit>
  void rasterize(int size, int rowBegin, int rowEnd, Emit&& emit) const;
};

/// The fragments of strands on a map, made on the fly as often as a method passes over them; only the
/// segments' indices are kept, by bands of rows. The strands, and an opaque map, must outlive it.
class FragmentStream {
 public:
  static constexpr int kBandRows = 8;

  /// Strands with a point or width that is not finite are dropped and counted. Errors: InvalidArgument
  /// (opacity outside [0, 1], negative widthScale or defaultWidth, a map of no or more than 32 768 texels a
  /// side), TooLarge (2³² points), Cancelled.
  static Result<FragmentStream> make(const StrandSet& strands, const LightView& view,
                                     const FragmentOptions& options = {}, const Context& context = {});

  const LightView& view() const { return view_; }
  const StrandSet& strands() const { return *strands_; }
  std::size_t texelCount() const { return std::size_t(view_.size) * std::size_t(view_.size); }
  std::size_t droppedStrands() const { return dropped_; }
  /// All points and widths are finite.
  bool usableStrand(std::size_t s) const { return bad_.empty() || !bad_[s]; }
  /// Diameter in scene units and opacity at a point, as the fragments have them.
  double widthAt(std::uint32_t point) const {
    return widthFactor_ * (strands_->widths.empty() ? 1.0 : double(strands_->widths[point]));
  }
  double opacityAt(std::uint32_t point) const {
    const auto& transparencies = strands_->transparencies;
    return transparencies.empty()
               ? options_.opacity
               : options_.opacity * (1 - std::clamp(double(transparencies[point]), 0., 1.));
  }
  int bandCount() const { return (view_.size + kBandRows - 1) / kBandRows; }

  /// call(fragment) for the fragments in rows [band · kBandRows, …), segments in ascending order.
  template <class Call>
  void forBand(int band, Call&& call) const;
  /// All bands, in parallel. Every texel is visited by one thread, its fragments in the same order for any
  /// number of threads.
  template <class Call>
  void forEach(const Context& context, Call&& call) const;

 private:
  struct Chunk {
    std::vector<std::vector<std::uint32_t>> bands;  ///< first points of the segments that touch the band
  };
  Chunk binned(std::size_t firstStrand, std::size_t endStrand);
  bool finiteStrand(std::size_t s) const;
  bool hidden(std::uint32_t texel, double depth) const;

  const StrandSet* strands_ = nullptr;
  LightView view_;
  FragmentOptions options_;
  double widthFactor_ = 1;
  std::vector<Chunk> chunks_;
  std::vector<std::uint8_t> bad_;  ///< a flag a strand
  std::size_t dropped_ = 0;
};

template <class Emit>
void MapSegment::rasterize(int size, int rowBegin, int rowEnd, Emit&& emit) const {
  const Vec3 d = b - a;
  const bool alongX = std::abs(d.x()) >= std::abs(d.y());
  const int major = alongX ? 0 : 1, minor = 1 - major;
  if (!(std::abs(d[major]) > 0)) return;  // a point on the map has no step to stand on
  const double slope = d[minor] / d[major], stretch = std::sqrt(1 + slope * slope);
  const double lowest = alongX ? 0 : rowBegin, highest = alongX ? size : rowEnd;
  double lo = std::max(std::min(a[major], b[major]), lowest);
  double hi = std::min(std::max(a[major], b[major]), highest);
  if (alongX && slope != 0) {  // only the columns where the line is near these rows
    const double x0 = a.x() + (rowBegin - 1 - a.y()) / slope, x1 = a.x() + (rowEnd + 1 - a.y()) / slope;
    lo = std::max(lo, std::min(x0, x1));
    hi = std::min(hi, std::max(x0, x1));
  }
  if (!(lo < hi)) return;
  const int first = int(std::ceil(lo - 0.5)), end = int(std::ceil(hi - 0.5));
  const double least = alongX ? rowBegin : 0, most = alongX ? rowEnd : size;
  for (int i = first; i < end; ++i) {
    const double step = i + 0.5 - a[major], across = a[minor] + step * slope;
    if (!(across >= least && across < most)) continue;
    const double u = std::clamp(step / d[major], 0.0, 1.0);
    const double t = perspective ? u * a.z() / (b.z() * (1 - u) + u * a.z()) : u;
    const int j = int(across);
    emit(alongX ? i : j, alongX ? j : i, a.z() + t * d.z(), from + t * (to - from), stretch);
  }
}

template <class Call>
void FragmentStream::forBand(int band, Call&& call) const {
  const int rowBegin = band * kBandRows, rowEnd = std::min(rowBegin + kBandRows, view_.size);
  MapSegment segment;
  for (const Chunk& chunk : chunks_) {
    for (const std::uint32_t point : chunk.bands[std::size_t(band)]) {
      const auto& points = strands_->points;
      if (!segment.set(view_, points[point].cast<double>(), points[point + 1].cast<double>())) continue;
      const double width0 = widthAt(point), width1 = widthAt(point + 1);
      const double opacity0 = opacityAt(point), opacity1 = opacityAt(point + 1);
      segment.rasterize(
          view_.size, rowBegin, rowEnd, [&](int x, int y, double depth, double t, double stretch) {
            const double alpha = (opacity0 + t * (opacity1 - opacity0)) * (width0 + t * (width1 - width0)) *
                                 stretch / view_.texelAt(depth);
            const std::uint32_t texel = std::uint32_t(y) * std::uint32_t(view_.size) + std::uint32_t(x);
            if (!(alpha > 0) || (options_.opaque != nullptr && hidden(texel, depth))) return;
            call(Fragment{texel, float(depth), std::min(float(alpha), kGreatestAlpha), float(t), point});
          });
    }
  }
}

template <class Call>
void FragmentStream::forEach(const Context& context, Call&& call) const {
  parallelFor(context, std::size_t(bandCount()), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t band = begin; band < end; ++band) forBand(int(band), call);
  });
}

}  // namespace coif
