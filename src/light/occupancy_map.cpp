// Occupancy and slab maps (Sintorn & Assarsson 2009), slabs holding amounts instead of counts.
#include <bit>

#include "light/map_passes.h"

namespace coif {
namespace {

class OccupancyMap : public VisibilityMap {
 public:
  OccupancyMap(const FragmentStream& stream, const VisibilityOptions& options, int channels, DepthRange range)
      : VisibilityMap(stream.view(), options, channels),
        range_(std::move(range)),
        words_(std::size_t(options.occupancySlices) / 32),
        slabs_(std::size_t(options.slabs)) {}

  Status fill(const FragmentStream& stream, const ChannelSource& source, const Context& context) {
    const std::size_t width = std::size_t(channels());
    COIF_TRY(checkMapBytes(double(stream.texelCount()) * 4 * double(words_ + slabs_ * width)));
    bits_.assign(stream.texelCount() * words_, 0u);
    amounts_.assign(stream.texelCount() * slabs_ * width, 0.0f);
    const FragmentValues values(source);
    stream.forEach(context, [&](const Fragment& f) {
      const std::size_t slice = std::size_t(sliceOf(f.texel, double(f.depth)));
      bits_[f.texel * words_ + slice / 32] |= 1u << (slice % 32);
      const auto v = values(f);
      float* at = &amounts_[(f.texel * slabs_ + slabOf(slice)) * width];
      for (std::size_t c = 0; c < width; ++c) at[c] += v[c];
    });
    return {};
  }

  double bytesPerTexel() const override {
    return 8 + 4.0 * double(words_) + 4.0 * double(slabs_ * std::size_t(channels()));
  }

  TransmittanceBound aPosterioriBound() const override {
    const std::size_t width = std::size_t(channels());
    double weighted = 0, weight = 0, worst = 0;
    for (std::size_t texel = 0; texel < range_.near.size(); ++texel) {
      double omega = 0;
      for (std::size_t s = 0; s < slabs_; ++s) {
        const double before = std::exp(-omega);
        omega += double(amounts_[(texel * slabs_ + s) * width]);
        const double taken = before - std::exp(-omega);
        weighted += taken * taken, weight += taken, worst = std::max(worst, taken);
      }
    }
    return {weight > 0 ? weighted / weight : 0, worst};
  }

 protected:
  void sumsAt(std::size_t texel, double depth, std::span<double> out) const override {
    std::ranges::fill(out, 0.0);
    if (range_.empty(texel) || !(depth > double(range_.near[texel]))) return;
    const double slices = 32.0 * double(words_);
    const double extent = double(range_.far[texel]) - double(range_.near[texel]);
    // far = near: one slice, and the point is behind it.
    const double d = extent > 0 ? (depth - double(range_.near[texel])) / extent : 2.0;
    if (d > 1) return addSlabs(texel, slabs_, out);
    const std::size_t slice = std::size_t(std::min(d * slices, slices - 1)), slab = slabOf(slice);
    addSlabs(texel, slab, out);
    const std::size_t perSlab = words_ / slabs_ * 32, firstSlice = slab * perSlab;
    const double total = countBits(texel, firstSlice, firstSlice + perSlab);
    if (total == 0) return;
    const bool own = bits_[texel * words_ + slice / 32] >> (slice % 32) & 1u;
    const double part =
        (countBits(texel, firstSlice, slice) + (own ? d * slices - double(slice) : 0.0)) / total;
    for (std::size_t c = 0; c < out.size(); ++c) {
      out[c] += part * double(amounts_[(texel * slabs_ + slab) * out.size() + c]);
    }
  }
  Interval intervalAt(std::size_t texel, double depth) const override {
    if (range_.empty(texel) || !(depth > double(range_.near[texel]))) return {0, 0};
    const std::size_t slab = slabOf(std::size_t(sliceOf(texel, depth))), width = std::size_t(channels());
    double from = 0;
    for (std::size_t s = 0; s < slab; ++s) from += double(amounts_[(texel * slabs_ + s) * width]);
    return {from, from + double(amounts_[(texel * slabs_ + slab) * width])};
  }

 private:
  std::size_t slabOf(std::size_t slice) const { return slice / (words_ / slabs_ * 32); }
  int sliceOf(std::size_t texel, double depth) const {
    const double extent = double(range_.far[texel]) - double(range_.near[texel]);
    if (!(extent > 0)) return 0;
    const double slices = 32.0 * double(words_);
    return int(std::clamp((depth - double(range_.near[texel])) / extent * slices, 0.0, slices - 1));
  }
  void addSlabs(std::size_t texel, std::size_t count, std::span<double> out) const {
    for (std::size_t s = 0; s < count; ++s) {
      for (std::size_t c = 0; c < out.size(); ++c) {
        out[c] += double(amounts_[(texel * slabs_ + s) * out.size() + c]);
      }
    }
  }
  /// Bits of slices [begin, end); begin at a word's start.
  double countBits(std::size_t texel, std::size_t begin, std::size_t end) const {
    int count = 0;
    for (std::size_t w = begin / 32; w * 32 < end; ++w) {
      std::uint32_t word = bits_[texel * words_ + w];
      if (end - w * 32 < 32) word &= (1u << (end - w * 32)) - 1;
      count += std::popcount(word);
    }
    return count;
  }

  DepthRange range_;
  std::size_t words_ = 4, slabs_ = 4;
  std::vector<std::uint32_t> bits_;
  std::vector<float> amounts_;  ///< texel, slab, channel
};

}  // namespace

MapResult buildOccupancy(const FragmentStream& stream, const VisibilityOptions& options,
                         const ChannelSource& channels, const Context& context) {
  auto map = std::make_unique<OccupancyMap>(stream, options, 1 + channels.count, depthRange(stream, context));
  COIF_TRY(map->fill(stream, channels, context));
  return MapResult(std::move(map));
}

}  // namespace coif
