// Opacity shadow maps and deep opacity maps: layers from a common depth, or from each texel's first hair.
#include <algorithm>

#include "light/layer_samples.h"
#include "light/map_passes.h"

namespace coif {
namespace {

class LayeredMap : public VisibilityMap {
 public:
  /// `first` empty: all layers begin at `origin`.
  LayeredMap(const LightView& view, const VisibilityOptions& options, int channels, std::vector<double> ends,
             std::vector<float> first, double origin)
      : VisibilityMap(view, options, channels),
        ends_(std::move(ends)),
        first_(std::move(first)),
        origin_(origin),
        stride_(ends_.size() * std::size_t(channels)) {}

  Status fill(const FragmentStream& stream, const ChannelSource& source, const Context& context) {
    COIF_TRY(checkMapBytes(double(stream.texelCount()) * 4 * double(stride_)));
    sums_.assign(stream.texelCount() * stride_, 0.0f);
    const std::size_t width = std::size_t(channels()), last = ends_.size() - 1;
    const bool ignore = options().past == PastLastLayer::Ignore && !first_.empty();
    const FragmentValues values(source);
    stream.forEach(context, [&](const Fragment& f) {
      std::size_t layer = layerOf(double(f.depth) - begin(f.texel));
      if (layer > last) {
        if (ignore) return;
        layer = last;
      }
      const auto v = values(f);
      float* at = &sums_[f.texel * stride_ + layer * width];
      for (std::size_t c = 0; c < width; ++c) at[c] += v[c];
    });
    constexpr std::size_t kTexels = 4096;
    parallelFor(context, stream.texelCount(), kTexels, [&](std::size_t from, std::size_t to) {
      for (std::size_t t = from; t < to; ++t) {
        float* at = &sums_[t * stride_];
        for (std::size_t i = width; i < stride_; ++i) at[i] += at[i - width];
      }
    });
    return {};
  }

  double bytesPerTexel() const override { return 4.0 * double(stride_ + (first_.empty() ? 0 : 1)); }

  double shareInFront(std::size_t texel, double fragmentDepth, double depth) const override {
    const std::size_t last = ends_.size() - 1;
    const double d = depth - begin(texel);
    const std::size_t layer = std::min(layerOf(d), last),
                      own = std::min(layerOf(fragmentDepth - begin(texel)), last);
    return layer == own ? partOf(layer, d) : own < layer ? 1 : 0;
  }

  TransmittanceBound aPosterioriBound() const override {
    const std::size_t width = std::size_t(channels());
    double weighted = 0, weight = 0, worst = 0;
    for (std::size_t at = 0; at < sums_.size(); at += stride_) {
      double before = 1;
      for (std::size_t k = 0; k < ends_.size() && sums_[at + stride_ - width] > 0; ++k) {
        const double behind = std::exp(-double(sums_[at + k * width])), taken = before - behind;
        weighted += taken * taken;
        weight += taken;
        worst = std::max(worst, taken);
        before = behind;
      }
    }
    return {weight > 0 ? weighted / weight : 0, worst};
  }

 protected:
  void sumsAt(std::size_t texel, double depth, std::span<double> out) const override {
    const double d = depth - begin(texel);
    if (!(d > 0)) {  // in front of the first hair, or no hair at all
      std::ranges::fill(out, 0.0);
      return;
    }
    const std::size_t layer = std::min(layerOf(d), ends_.size() - 1);
    const double part = partOf(layer, d);
    const float* at = &sums_[texel * stride_ + layer * out.size()];
    for (std::size_t c = 0; c < out.size(); ++c) {
      const double behind = at[c], before = layer == 0 ? 0.0 : double(*(at + c - out.size()));
      out[c] = before + part * (behind - before);
    }
  }
  Interval intervalAt(std::size_t texel, double depth) const override {
    const double d = depth - begin(texel);
    if (!(d > 0)) return {0, 0};
    const std::size_t width = std::size_t(channels()), layer = std::min(layerOf(d), ends_.size() - 1);
    const float* at = &sums_[texel * stride_ + layer * width];
    const bool unknownBehind = options().past == PastLastLayer::Ignore && !first_.empty() && d > ends_.back();
    if (unknownBehind) return {double(*at), HUGE_VAL};
    return {layer == 0 ? 0.0 : double(*(at - width)), double(*at)};
  }

 private:
  double begin(std::size_t texel) const { return first_.empty() ? origin_ : double(first_[texel]); }
  /// ends_.size() past the last.
  std::size_t layerOf(double d) const {
    return std::size_t(std::upper_bound(ends_.begin(), ends_.end(), d) - ends_.begin());
  }

  /// Of a layer, in front of a depth.
  double partOf(std::size_t layer, double d) const {
    const double from = layer == 0 ? 0 : ends_[layer - 1];
    return std::clamp((d - from) / (ends_[layer] - from), 0.0, 1.0);
  }

  std::vector<double> ends_;
  std::vector<float> first_;
  double origin_ = 0;
  std::size_t stride_ = 1;
  std::vector<float> sums_;  ///< texel, layer, channel: everything in front of the layer's end
};

double usableExtent(double extent, const FragmentStream& stream) {
  return extent > 0 ? extent : std::max(1e-6 * stream.view().depthRange, 1e-12);
}

MapResult withLayers(const FragmentStream& stream, const VisibilityOptions& options, const DepthRange& range,
                     const ChannelSource& channels, const Context& context) {
  std::vector<double> ends = deepLayerEnds(options.sizes, options.layers, options.layerSize);
  if (options.past == PastLastLayer::EnlargeLast) {
    ends.back() = std::max(ends.back(), range.greatestExtent() * (1 + 1e-6));
  }
  auto map = std::make_unique<LayeredMap>(stream.view(), options, 1 + channels.count, std::move(ends),
                                          range.near, 0);
  COIF_TRY(map->fill(stream, channels, context));
  return MapResult(std::move(map));
}

constexpr int kChoices[] = {3, 7, 11, 15, 23, 31, 47, 63, 95, 127, 191, 255};
// A layer takes away at least what one fragment does: there comes a point where more layers are in vain.
constexpr double kInVain = 1.03;

struct Candidate {
  int layers;
  double size, bound;
};

/// Fewest layers first; nothing beyond the first that meets the bound on the sampled texels, and nothing that
/// is not worth its layers.
std::vector<Candidate> candidates(const FragmentStream& stream, const VisibilityOptions& options,
                                  const Context& context) {
  const LayerSamples samples(stream, context);
  std::vector<Candidate> all;
  for (const int layers : kChoices) {
    const auto verdict = samples.leastBound(options.sizes, layers, options.past, context);
    all.push_back({layers, verdict.size, verdict.value});
  }
  const double least = std::ranges::min_element(all, {}, &Candidate::bound)->bound;
  const double aim = std::max(options.bound, kInVain * least);
  std::erase_if(all, [&](const Candidate& c) { return c.bound > aim; });
  return all;
}

/// Few fragments a texel: sorted, they take no more memory than three layers, and are exact.
bool listsAreSmall(const FragmentStream& stream, std::uint64_t fragments, int channels) {
  const double texels = double(stream.texelCount());
  return exactMapBytes(texels, double(fragments), channels) <= texels * 4 * (1 + 3 * channels);
}

}  // namespace

MapResult buildOpacity(const FragmentStream& stream, const VisibilityOptions& options,
                       const ChannelSource& channels, const Context& context) {
  const auto [lo, hi] = depthRange(stream, context).whole();
  std::vector<double> ends(std::size_t(options.slices));
  const double extent = usableExtent((hi - lo) * (1 + 1e-6), stream);
  for (std::size_t k = 0; k < ends.size(); ++k) ends[k] = extent * double(k + 1) / double(ends.size());
  auto map = std::make_unique<LayeredMap>(stream.view(), options, 1 + channels.count, std::move(ends),
                                          std::vector<float>{}, lo);
  COIF_TRY(map->fill(stream, channels, context));
  return MapResult(std::move(map));
}

MapResult buildDeepOpacity(const FragmentStream& stream, const VisibilityOptions& options,
                           const ChannelSource& channels, const Context& context) {
  const DepthRange range = depthRange(stream, context);
  const auto build = [&](int layers, double size) {
    VisibilityOptions chosen = options;
    chosen.layers = layers;
    chosen.layerSize = size;
    return withLayers(stream, chosen, range, channels, context);
  };
  if (options.layers > 0) {
    const double size =
        options.layerSize > 0
            ? options.layerSize
            : chooseLayerSize(stream, options.sizes, options.layers, options.past, context).size;
    return build(options.layers, size);
  }
  if (options.leaveOut && listsAreSmall(stream, range.fragments, 1 + channels.count)) {
    VisibilityOptions lists = options;
    lists.method = VisibilityMethod::Exact;
    return buildExact(stream, lists, channels, context);
  }
  // The whole map decides; the sampled texels only say where to begin.
  const std::vector<Candidate> tried = candidates(stream, options, context);
  MapResult map = build(tried[0].layers, options.layerSize > 0 ? options.layerSize : tried[0].size);
  for (std::size_t i = 1; i < tried.size() && map.ok(); ++i) {
    const double bound = (*map)->aPosterioriBound().mean;
    if (bound <= options.bound || tried[i - 1].bound > options.bound) break;
    map = build(tried[i].layers, options.layerSize > 0 ? options.layerSize : tried[i].size);
  }
  return map;
}

}  // namespace coif
