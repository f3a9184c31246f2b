// Where the layers of a deep opacity map end: four laws, shared by the CPU and the GPU.
#pragma once

#include <span>
#include <vector>

#include "coif/base/context.h"

namespace coif {

class FragmentStream;

/// d_k over the size s, k = 1 … K: k; k (k + 1) / 2; 2^k − 1; F_{k+2} − 1 with F_1 = F_2 = 1.
enum class LayerSizes { Constant, Linear, PowersOfTwo, Fibonacci };

/// Fragments behind the last layer: cast no shadow; belong to the last layer; or the last layer reaches to
/// the end of the hair.
enum class PastLastLayer { Ignore, AddToLast, EnlargeLast };

const char* name(LayerSizes law);
const char* name(PastLastLayer rule);

/// d_1 … d_K for a size s > 0. K is clamped to 1 … 1024.
std::vector<double> deepLayerEnds(LayerSizes law, int layers, double size);

struct LayerChoice {
  double size = 1;   ///< s, scene units
  double error = 0;  ///< mean |ΔT| at the fragments of the sampled texels
};

/// The size s for which K layers leave the least mean |ΔT| at the fragments of one texel in 64 (of every
/// texel on maps below 64 a side), tried over 24 sizes in geometric steps. Costs less than a pass.
LayerChoice chooseLayerSize(const FragmentStream& stream, LayerSizes law, int layers, PastLastLayer past,
                            const Context& context = {});

}  // namespace coif
