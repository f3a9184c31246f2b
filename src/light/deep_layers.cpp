#include "coif/light/deep_layers.h"

#include <algorithm>
#include <cmath>

#include "coif/light/fragments.h"

namespace coif {
namespace {

struct Sample {
  float depth, beta;
};

/// Fragments of a part of the texels, sorted by depth.
std::vector<std::vector<Sample>> sampledTexels(const FragmentStream& stream) {
  const int size = stream.view().size, step = size >= 64 ? 8 : 1;
  const std::size_t columns = std::size_t((size + step - 1) / step);
  std::vector<std::vector<Sample>> texels(columns * columns);
  const auto wanted = [&](int v) { return v % step == step / 2; };
  for (int band = 0; band < stream.bandCount(); ++band) {
    stream.forBand(band, [&](const Fragment& f) {
      const int x = int(f.texel) % size, y = int(f.texel) / size;
      if (!wanted(x) || !wanted(y)) return;
      texels[std::size_t(y / step) * columns + std::size_t(x / step)].push_back({f.depth, f.beta()});
    });
  }
  for (auto& texel : texels) {
    std::stable_sort(texel.begin(), texel.end(),
                     [](const Sample& a, const Sample& b) { return a.depth < b.depth; });
  }
  return texels;
}

// Σ |ΔT| over a texel's fragments.
double texelError(const std::vector<Sample>& texel, const std::vector<double>& ends, PastLastLayer past) {
  const std::size_t last = ends.size() - 1;
  std::vector<double> sums(ends.size(), 0.0);
  const auto layerOf = [&](double d) {
    return std::size_t(std::upper_bound(ends.begin(), ends.end(), d) - ends.begin());
  };
  const double first = texel.front().depth;
  for (const Sample& s : texel) {
    const std::size_t layer = layerOf(s.depth - first);
    if (layer > last && past == PastLastLayer::Ignore) continue;
    sums[std::min(layer, last)] += s.beta;
  }
  for (std::size_t k = 1; k < sums.size(); ++k) sums[k] += sums[k - 1];
  double exact = 0, error = 0;
  for (const Sample& s : texel) {
    const double d = s.depth - first;
    const std::size_t layer = std::min(layerOf(d), last);
    const double from = layer == 0 ? 0 : ends[layer - 1], before = layer == 0 ? 0 : sums[layer - 1];
    const double part = std::min(1.0, (d - from) / (ends[layer] - from));
    error += std::abs(std::exp(-(before + part * (sums[layer] - before))) - std::exp(-exact));
    exact += s.beta;
  }
  return error;
}

}  // namespace

const char* name(LayerSizes law) {
  switch (law) {
    case LayerSizes::Constant:
      return "constant";
    case LayerSizes::Linear:
      return "linear";
    case LayerSizes::PowersOfTwo:
      return "powers of two";
    case LayerSizes::Fibonacci:
      return "Fibonacci";
  }
  return "unknown";
}

const char* name(PastLastLayer rule) {
  switch (rule) {
    case PastLastLayer::Ignore:
      return "ignore";
    case PastLastLayer::AddToLast:
      return "add to the last";
    case PastLastLayer::EnlargeLast:
      return "enlarge the last";
  }
  return "unknown";
}

std::vector<double> deepLayerEnds(LayerSizes law, int layers, double size) {
  std::vector<double> ends(std::size_t(std::clamp(layers, 1, 1024)));
  double step = size, previousStep = size, end = 0;
  for (std::size_t k = 0; k < ends.size(); ++k) {
    end += step;
    ends[k] = end;
    switch (law) {
      case LayerSizes::Constant:
        break;
      case LayerSizes::Linear:
        step += size;
        break;
      case LayerSizes::PowersOfTwo:
        step *= 2;
        break;
      case LayerSizes::Fibonacci: {  // 1, 2, 3, 5, …
        const double next = k == 0 ? 2 * size : step + previousStep;
        previousStep = step;
        step = next;
        break;
      }
    }
    // Beyond any scene: later layers stay empty but keep ascending, finite ends.
    step = std::min(step, 1e30 * size);
  }
  return ends;
}

LayerChoice chooseLayerSize(const FragmentStream& stream, LayerSizes law, int layers, PastLastLayer past,
                            const Context& context) {
  constexpr int kSizes = 24;
  constexpr double kFinest = 2e-3;  // of the deepest texel's extent, for the last layer's end
  const auto texels = sampledTexels(stream);
  double extent = 0, count = 0;
  for (const auto& texel : texels) {
    if (!texel.empty()) extent = std::max(extent, double(texel.back().depth) - double(texel.front().depth));
    count += double(texel.size());
  }
  const double unit = deepLayerEnds(law, layers, 1).back();
  if (!(extent > 0)) return {std::max(1e-3 * stream.view().depthRange, 1e-12) / unit, 0};
  LayerChoice best{extent / unit, HUGE_VAL};
  for (int i = 0; i < kSizes; ++i) {
    const double end = 1.001 * extent * std::pow(kFinest, double(i) / (kSizes - 1));
    std::vector<double> ends = deepLayerEnds(law, layers, end / unit);
    if (past == PastLastLayer::EnlargeLast) ends.back() = std::max(ends.back(), 1.001 * extent);
    const double error = parallelSum(context, texels.size(), 64, [&](std::size_t from, std::size_t to) {
      double sum = 0;
      for (std::size_t t = from; t < to; ++t)
        sum += texels[t].empty() ? 0 : texelError(texels[t], ends, past);
      return sum;
    });
    if (error / count < best.error) best = {end / unit, error / count};
  }
  return best;
}

}  // namespace coif
