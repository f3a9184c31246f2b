#include "coif/light/fragments.h"

#include "coif/light/opaque_map.h"

namespace coif {
namespace {

constexpr int kGreatestSize = 32768;
constexpr std::size_t kStrandsAChunk = 4096;
constexpr double kHairMeters = 8e-5;
constexpr double kRowSlack = 1e-6;  // rows: far above rounding, far below what costs time

Status check(const StrandSet& strands, const LightView& view, const FragmentOptions& options) {
  if (!(options.opacity >= 0 && options.opacity <= 1)) {
    return makeError(ErrorCode::InvalidArgument, "the opacity of hair has to be in [0, 1]");
  }
  if (!(options.widthScale >= 0 && std::isfinite(options.widthScale)) ||
      !(options.defaultWidth >= 0 && std::isfinite(options.defaultWidth))) {
    return makeError(ErrorCode::InvalidArgument, "the width of hair has to be finite and not negative");
  }
  if (view.size < 1 || view.size > kGreatestSize || !(view.texel > 0) || !std::isfinite(view.texel)) {
    return makeError(ErrorCode::InvalidArgument, "a map needs 1 … 32768 texels a side, of positive width");
  }
  if (options.opaque != nullptr && options.opaque->view().size != view.size) {
    return makeError(ErrorCode::InvalidArgument, "the opaque map has another size than the hair's");
  }
  if (strands.points.size() >= kNone) {
    return makeError(ErrorCode::TooLarge, "strands for a map may have at most 2^32 - 2 points");
  }
  return validate(strands, false);
}

}  // namespace

int suggestedMapSize(const StrandSet& strands, const Box& box, int most) {
  constexpr double kWidthsATexel = 10;
  constexpr int kLeast = 16;
  double width = kHairMeters / strands.metersPerUnit;
  std::vector<float> widths = strands.widths;
  std::erase_if(widths, [](float w) { return !(w > 0) || !std::isfinite(w); });
  if (!widths.empty()) {
    const auto middle = widths.begin() + std::ptrdiff_t(widths.size() / 2);
    std::nth_element(widths.begin(), middle, widths.end());
    width = double(*middle);
  }
  const double size = box.diagonal() / (kWidthsATexel * width);
  return std::max(kLeast, size < most ? int(size) : most);
}

bool MapSegment::set(const LightView& view, const Vec3& worldA, const Vec3& worldB) {
  from = 0, to = 1;
  perspective = view.perspective;
  a = view.project(worldA), b = view.project(worldB);
  if (!perspective) return true;
  const double near = kNearFraction * view.depthRange;
  const double za = a.z(), zb = b.z();
  if (!(za > near) && !(zb > near)) return false;
  if (!(za > near)) {
    from = (near - za) / (zb - za);
    a = view.project(worldA + from * (worldB - worldA));
    a.z() = near;
  } else if (!(zb > near)) {
    to = (near - za) / (zb - za);
    b = view.project(worldA + to * (worldB - worldA));
    b.z() = near;
  }
  return true;
}

bool FragmentStream::hidden(std::uint32_t texel, double depth) const {
  return options_.opaque->blocksTexel(texel, depth);
}

bool FragmentStream::finiteStrand(std::size_t s) const {
  for (std::uint64_t p = strands_->offsets[s]; p < strands_->offsets[s + 1]; ++p) {
    if (!strands_->points[p].allFinite()) return false;
    if (!strands_->widths.empty() && !std::isfinite(strands_->widths[p])) return false;
    if (!strands_->transparencies.empty() && !std::isfinite(strands_->transparencies[p])) return false;
  }
  return true;
}

FragmentStream::Chunk FragmentStream::binned(std::size_t firstStrand, std::size_t endStrand) {
  Chunk chunk;
  chunk.bands.resize(std::size_t(bandCount()));
  MapSegment segment;
  for (std::size_t s = firstStrand; s < endStrand; ++s) {
    if (!finiteStrand(s)) {
      bad_[s] = 1;
      continue;
    }
    for (std::uint64_t p = strands_->offsets[s]; p + 1 < strands_->offsets[s + 1]; ++p) {
      if (!segment.set(view_, strands_->points[p].cast<double>(), strands_->points[p + 1].cast<double>())) {
        continue;
      }
      const double last = view_.size - 1;
      const double lo = std::min(segment.a.y(), segment.b.y()) - kRowSlack;
      const double hi = std::max(segment.a.y(), segment.b.y()) + kRowSlack;
      const double left = std::min(segment.a.x(), segment.b.x()),
                   right = std::max(segment.a.x(), segment.b.x());
      if (!(hi >= 0 && lo < view_.size && right >= 0 && left < view_.size)) continue;
      const int firstBand = int(std::clamp(lo, 0.0, last)) / kBandRows;
      const int lastBand = int(std::clamp(hi, 0.0, last)) / kBandRows;
      for (int band = firstBand; band <= lastBand; ++band) {
        chunk.bands[std::size_t(band)].push_back(std::uint32_t(p));
      }
    }
  }
  return chunk;
}

Result<FragmentStream> FragmentStream::make(const StrandSet& strands, const LightView& view,
                                            const FragmentOptions& options, const Context& context) {
  COIF_TRY(check(strands, view, options));
  FragmentStream stream;
  stream.strands_ = &strands;
  stream.view_ = view;
  stream.options_ = options;
  const double standard =
      options.defaultWidth > 0 ? options.defaultWidth : kHairMeters / strands.metersPerUnit;
  stream.widthFactor_ = options.widthScale * (strands.widths.empty() ? standard : 1.0);
  const std::size_t count = (strands.strandCount() + kStrandsAChunk - 1) / kStrandsAChunk;
  stream.chunks_.resize(count);
  stream.bad_.assign(strands.strandCount(), 0);
  parallelFor(context, strands.strandCount(), kStrandsAChunk, [&](std::size_t begin, std::size_t end) {
    stream.chunks_[begin / kStrandsAChunk] = stream.binned(begin, end);
  });
  if (context.cancelled()) return makeError(ErrorCode::Cancelled, "the shadow map was cancelled");
  stream.dropped_ = std::size_t(std::count(stream.bad_.begin(), stream.bad_.end(), 1));
  return stream;
}

}  // namespace coif
