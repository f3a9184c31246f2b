// Exact lists of a part of a map's texels, to judge deep opacity layers before they are built.
#pragma once

#include <span>
#include <vector>

#include "coif/light/deep_layers.h"

namespace coif {

class LayerSamples {
 public:
  /// One texel in 64, on maps below 64 a side every one. One pass.
  LayerSamples(const FragmentStream& stream, const Context& context);

  struct Verdict {
    double size = 1;   ///< s
    double value = 0;  ///< what was made least
  };
  /// Sizes for which the last layer ends between 1/500 of and all of the deepest texel's extent.
  /// Least mean |ΔT| at the fragments.
  Verdict leastError(LayerSizes law, int layers, PastLastLayer past, const Context& context) const;
  /// Least mean bound, weighted as VisibilityMap::aPosterioriBound().
  Verdict leastBound(LayerSizes law, int layers, PastLastLayer past, const Context& context) const;

 private:
  struct Sample {
    float depth, beta;
  };
  using Texel = std::vector<Sample>;
  static double layerSums(const Texel& texel, const std::vector<double>& ends, PastLastLayer past,
                          std::span<double> sums);
  static double texelError(const Texel& texel, const std::vector<double>& ends, PastLastLayer past,
                           std::span<double> sums);
  template <class Judge>
  Verdict least(LayerSizes law, int layers, PastLastLayer past, Judge&& judge) const;

  std::vector<Texel> texels_;
  double extent_ = 0, fragments_ = 0;
  double fallback_ = 1;  ///< the last layer's end when there is nothing to judge by
};

}  // namespace coif
