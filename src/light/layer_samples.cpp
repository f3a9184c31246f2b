#include "light/layer_samples.h"

#include <algorithm>
#include <cmath>

#include "coif/base/parallel.h"
#include "coif/light/fragments.h"

namespace coif {
namespace {

constexpr int kSizes = 24;
constexpr double kFinest = 2e-3;       // of the deepest texel's extent
constexpr double kBehindLast = 1.001;  // so that the last fragment is within the last layer
constexpr std::size_t kTexelsAChunk = 64;

std::size_t layerOf(const std::vector<double>& ends, double d) {
  return std::size_t(std::upper_bound(ends.begin(), ends.end(), d) - ends.begin());
}

}  // namespace

LayerSamples::LayerSamples(const FragmentStream& stream, const Context& context)
    : fallback_(std::max(1e-3 * stream.view().depthRange, 1e-12)) {
  const int size = stream.view().size, step = size >= 64 ? 8 : 1;
  const std::size_t columns = std::size_t((size + step - 1) / step);
  texels_.resize(columns * columns);
  const auto wanted = [&](int v) { return v % step == step / 2; };
  stream.forEach(context, [&](const Fragment& f) {
    const int x = int(f.texel) % size, y = int(f.texel) / size;
    if (!wanted(x) || !wanted(y)) return;
    texels_[std::size_t(y / step) * columns + std::size_t(x / step)].push_back({f.depth, f.beta()});
  });
  std::erase_if(texels_, [](const Texel& texel) { return texel.empty(); });
  for (Texel& texel : texels_) {
    std::stable_sort(texel.begin(), texel.end(),
                     [](const Sample& a, const Sample& b) { return a.depth < b.depth; });
    extent_ = std::max(extent_, double(texel.back().depth) - double(texel.front().depth));
    fragments_ += double(texel.size());
  }
}

// Everything in front of each layer's end; returns the first depth.
double LayerSamples::layerSums(const Texel& texel, const std::vector<double>& ends, PastLastLayer past,
                               std::span<double> sums) {
  const std::size_t last = ends.size() - 1;
  const double first = texel.front().depth;
  std::ranges::fill(sums, 0.0);
  for (const Sample& s : texel) {
    const std::size_t layer = layerOf(ends, s.depth - first);
    if (layer <= last || past != PastLastLayer::Ignore) sums[std::min(layer, last)] += s.beta;
  }
  for (std::size_t k = 1; k < sums.size(); ++k) sums[k] += sums[k - 1];
  return first;
}

double LayerSamples::texelError(const Texel& texel, const std::vector<double>& ends, PastLastLayer past,
                                std::span<double> sums) {
  const double first = layerSums(texel, ends, past, sums);
  double exact = 0, error = 0;
  for (const Sample& s : texel) {
    const double d = s.depth - first;
    const std::size_t layer = std::min(layerOf(ends, d), ends.size() - 1);
    const double from = layer == 0 ? 0 : ends[layer - 1], before = layer == 0 ? 0 : sums[layer - 1];
    const double part = std::min(1.0, (d - from) / (ends[layer] - from));
    error += std::abs(std::exp(-(before + part * (sums[layer] - before))) - std::exp(-exact));
    exact += s.beta;
  }
  return error;
}

template <class Judge>
LayerSamples::Verdict LayerSamples::least(LayerSizes law, int layers, PastLastLayer past,
                                          Judge&& judge) const {
  const double unit = deepLayerEnds(law, layers, 1).back();
  if (!(extent_ > 0)) return {fallback_ / unit, 0};
  Verdict best{extent_ / unit, HUGE_VAL};
  for (int i = 0; i < kSizes; ++i) {
    const double end = kBehindLast * extent_ * std::pow(kFinest, double(i) / (kSizes - 1));
    std::vector<double> ends = deepLayerEnds(law, layers, end / unit);
    if (past == PastLastLayer::EnlargeLast) ends.back() = std::max(ends.back(), kBehindLast * extent_);
    const double value = judge(ends);
    if (value < best.value) best = {end / unit, value};
  }
  return best;
}

LayerSamples::Verdict LayerSamples::leastError(LayerSizes law, int layers, PastLastLayer past,
                                               const Context& context) const {
  return least(law, layers, past, [&](const std::vector<double>& ends) {
    const double sum =
        parallelSum(context, texels_.size(), kTexelsAChunk, [&](std::size_t begin, std::size_t end) {
          std::vector<double> sums(ends.size());
          double error = 0;
          for (std::size_t t = begin; t < end; ++t) error += texelError(texels_[t], ends, past, sums);
          return error;
        });
    return sum / fragments_;
  });
}

LayerSamples::Verdict LayerSamples::leastBound(LayerSizes law, int layers, PastLastLayer past,
                                               const Context&) const {
  return least(law, layers, past, [&](const std::vector<double>& ends) {
    std::vector<double> sums(ends.size());
    double weighted = 0, weight = 0;
    for (const Texel& texel : texels_) {
      layerSums(texel, ends, past, sums);
      double before = 1;
      for (const double sum : sums) {
        const double behind = std::exp(-sum), taken = before - behind;
        weighted += taken * taken, weight += taken;
        before = behind;
      }
    }
    return weight > 0 ? weighted / weight : 0;
  });
}

}  // namespace coif
