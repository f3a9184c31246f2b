#include "coif/light/deep_layers.h"

#include <algorithm>

#include "light/layer_samples.h"

namespace coif {

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
  const auto verdict = LayerSamples(stream, context).leastError(law, layers, past, context);
  return {verdict.size, verdict.value};
}

}  // namespace coif
