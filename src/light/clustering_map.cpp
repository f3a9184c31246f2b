// Density clustering: range, means, then deviations and amounts by the nearest updated mean.
#include <limits>

#include "light/cluster_bins.h"
#include "light/map_passes.h"

namespace coif {

void clusterBins(std::span<const float> means, std::span<const float> deviations,
                 std::span<ClusterBin> bins) {
  constexpr float kRoot3 = 1.7320508f;
  float lowest = 0;  // midpoint to the cluster before, or the range's beginning
  for (std::size_t j = 0; j < means.size(); ++j) {
    if (std::isnan(means[j])) continue;
    std::size_t next = j + 1;
    while (next < means.size() && std::isnan(means[next])) ++next;
    const float highest = next < means.size() ? 0.5f * (means[j] + means[next]) : 1;
    bins[j].from = std::max(means[j] - kRoot3 * deviations[j], lowest);
    bins[j].to = std::min(means[j] + kRoot3 * deviations[j], highest);
    lowest = highest;
  }
}

namespace {

class ClusteringMap : public VisibilityMap {
 public:
  ClusteringMap(const FragmentStream& stream, const VisibilityOptions& options, int channels)
      : VisibilityMap(stream.view(), options, channels), clusters_(std::size_t(options.clusters)) {}

  Status fill(const FragmentStream& stream, const ChannelSource& source, const Context& context) {
    const std::size_t width = std::size_t(channels()), count = stream.texelCount() * clusters_;
    COIF_TRY(checkMapBytes(double(count) * (4 * double(width) + 16)));
    const DepthRange range = depthRange(stream, context);
    const std::vector<float> means = updatedMeans(stream, range, context);
    amounts_.assign(count * width, 0.0f);
    std::vector<float> squares(count, 0.0f);
    const FragmentValues values(source);
    stream.forEach(context, [&](const Fragment& f) {
      const double d = relative(range, f);
      const std::size_t at =
          f.texel * clusters_ + nearestMean(std::span(means).subspan(f.texel * clusters_, clusters_), d);
      const auto v = values(f);
      const double away = d - double(means[at]);
      squares[at] += float(double(v[0]) * away * away);
      for (std::size_t c = 0; c < width; ++c) amounts_[at * width + c] += v[c];
    });
    bins_.assign(count, {});
    std::vector<float> deviations(count, 0.0f);
    for (std::size_t i = 0; i < count; ++i) {
      if (amounts_[i * width] > 0) deviations[i] = std::sqrt(squares[i] / amounts_[i * width]);
    }
    for (std::size_t t = 0; t < stream.texelCount(); ++t) {
      if (range.empty(t)) continue;
      const std::size_t at = t * clusters_;
      clusterBins(std::span(means).subspan(at, clusters_), std::span(deviations).subspan(at, clusters_),
                  std::span(bins_).subspan(at, clusters_));
      for (std::size_t j = 0; j < clusters_; ++j) {
        const float extent = range.far[t] - range.near[t];
        bins_[at + j].from = range.near[t] + bins_[at + j].from * extent;
        bins_[at + j].to = range.near[t] + bins_[at + j].to * extent;
      }
    }
    return {};
  }

  double bytesPerTexel() const override { return double(clusters_) * (8 + 4.0 * channels()); }

 protected:
  void sumsAt(std::size_t texel, double depth, std::span<double> out) const override {
    std::ranges::fill(out, 0.0);
    for (std::size_t j = texel * clusters_; j < (texel + 1) * clusters_; ++j) {
      const double from = bins_[j].from, to = bins_[j].to;
      if (!(depth > from)) continue;
      const double part = to > from ? std::min(1.0, (depth - from) / (to - from)) : 1.0;
      for (std::size_t c = 0; c < out.size(); ++c) out[c] += part * double(amounts_[j * out.size() + c]);
    }
  }

 private:
  static double relative(const DepthRange& range, const Fragment& f) {
    const double extent = double(range.far[f.texel]) - double(range.near[f.texel]);
    return extent > 0 ? (double(f.depth) - double(range.near[f.texel])) / extent : 0;
  }

  // One round of k-means from means spread evenly over the texel's range; NaN where a cluster is empty.
  std::vector<float> updatedMeans(const FragmentStream& stream, const DepthRange& range,
                                  const Context& context) const {
    std::vector<float> weights(stream.texelCount() * clusters_, 0.0f), means = weights;
    stream.forEach(context, [&](const Fragment& f) {
      const double d = relative(range, f), beta = f.beta();
      const std::size_t nearest = std::min(std::size_t(d * double(clusters_)), clusters_ - 1);
      weights[f.texel * clusters_ + nearest] += float(beta);
      means[f.texel * clusters_ + nearest] += float(beta * d);
    });
    for (std::size_t i = 0; i < means.size(); ++i) {
      means[i] = weights[i] > 0 ? means[i] / weights[i] : std::numeric_limits<float>::quiet_NaN();
    }
    return means;
  }

  std::size_t clusters_ = 4;
  std::vector<ClusterBin> bins_;  ///< texel, cluster; depths
  std::vector<float> amounts_;    ///< texel, cluster, channel
};

}  // namespace

MapResult buildClustering(const FragmentStream& stream, const VisibilityOptions& options,
                          const ChannelSource& channels, const Context& context) {
  auto map = std::make_unique<ClusteringMap>(stream, options, 1 + channels.count);
  COIF_TRY(map->fill(stream, channels, context));
  return MapResult(std::move(map));
}

}  // namespace coif
