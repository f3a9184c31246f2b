// The truth: every texel's fragments sorted by depth, with running sums.
#include <numeric>

#include "light/map_passes.h"

namespace coif {
namespace {

class ExactMap : public VisibilityMap {
 public:
  ExactMap(const FragmentStream& stream, const VisibilityOptions& options, const ChannelSource& channels)
      : VisibilityMap(stream.view(), options, 1 + channels.count), starts_(stream.texelCount() + 1, 0) {}

  Status fill(const FragmentStream& stream, const ChannelSource& source, const Context& context) {
    stream.forEach(context, [&](const Fragment& f) { ++starts_[f.texel + 1]; });
    std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
    const std::size_t width = std::size_t(channels());
    COIF_TRY(checkMapBytes(double(starts_.back()) * 4 * double(1 + width)));
    depths_.resize(starts_.back());
    sums_.resize(starts_.back() * width);
    std::vector<std::uint64_t> next(starts_.begin(), starts_.end() - 1);
    const FragmentValues values(source);
    stream.forEach(context, [&](const Fragment& f) {
      const std::size_t at = next[f.texel]++;
      depths_[at] = f.depth;
      const auto v = values(f);
      std::copy_n(v.begin(), width, sums_.begin() + std::ptrdiff_t(at * width));
    });
    constexpr std::size_t kTexels = 1024;
    parallelFor(context, starts_.size() - 1, kTexels, [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t) sortTexel(t);
    });
    return {};
  }

  double bytesPerTexel() const override {
    const double texels = double(starts_.size() - 1);
    return exactMapBytes(texels, double(depths_.size()), channels()) / texels;
  }
  TransmittanceBound aPosterioriBound() const override { return {0, 0}; }

 protected:
  void sumsAt(std::size_t texel, double depth, std::span<double> out) const override {
    const auto begin = depths_.begin() + std::ptrdiff_t(starts_[texel]);
    const auto end = depths_.begin() + std::ptrdiff_t(starts_[texel + 1]);
    const auto at = std::lower_bound(begin, end, float(depth));  // strictly in front: not itself
    for (std::size_t c = 0; c < out.size(); ++c) {
      out[c] = at == begin ? 0.0 : double(sums_[std::size_t(at - depths_.begin() - 1) * out.size() + c]);
    }
  }
  Interval intervalAt(std::size_t texel, double depth) const override {
    std::array<double, 1 + ChannelSource::kMost> out;
    sumsAt(texel, depth, std::span(out).first(std::size_t(channels())));
    return {out[0], out[0]};
  }

 private:
  void sortTexel(std::size_t texel) {
    const std::size_t begin = starts_[texel], count = starts_[texel + 1] - begin,
                      width = std::size_t(channels());
    if (count == 0) return;
    std::vector<std::uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      const float da = depths_[begin + a], db = depths_[begin + b];
      return da != db ? da < db : a < b;
    });
    std::vector<float> depths(count), sums(count * width);
    std::vector<double> running(width, 0.0);
    for (std::size_t i = 0; i < count; ++i) {
      depths[i] = depths_[begin + order[i]];
      for (std::size_t c = 0; c < width; ++c) {
        running[c] += double(sums_[(begin + order[i]) * width + c]);
        sums[i * width + c] = float(running[c]);
      }
    }
    std::ranges::copy(depths, depths_.begin() + std::ptrdiff_t(begin));
    std::ranges::copy(sums, sums_.begin() + std::ptrdiff_t(begin * width));
  }

  std::vector<std::uint64_t> starts_;
  std::vector<float> depths_, sums_;
};

}  // namespace

MapResult buildExact(const FragmentStream& stream, const VisibilityOptions& options,
                     const ChannelSource& channels, const Context& context) {
  auto map = std::make_unique<ExactMap>(stream, options, channels);
  COIF_TRY(map->fill(stream, channels, context));
  return MapResult(std::move(map));
}

}  // namespace coif
