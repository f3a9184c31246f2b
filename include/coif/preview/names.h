// The words by which commands and scripts choose how a picture is made.
#pragma once

#include <span>
#include <string_view>

#include "coif/preview/preview.h"

namespace coif {

/// "studio", "kajiya-kay", "marschner" (R, TT, TRT), "energy-conserving" (Chiang), "dual-scattering".
std::span<const char* const> shadingNames();
/// "none", "opacity", "density-clustering", "light-map", "deep-opacity", "occupancy", "exact".
std::span<const char* const> visibilityNames();
/// "auto", "opaque", "stochastic", "alpha-to-coverage", "weighted-average", "occupancy-ordered", "depth-layers",
/// "half-angle-slices", "exact-lists".
std::span<const char* const> transparencyNames();

/// Sets what the word means. Errors: InvalidArgument for a word that is none, with those that are.
Status setShading(PreviewOptions& options, std::string_view word);  ///< with the fibre's model
Status setVisibility(PreviewOptions& options, std::string_view word);
Status setTransparency(PreviewOptions& options, std::string_view word);

}  // namespace coif
