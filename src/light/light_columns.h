// The light map's second half: what columns of cells let through.
#pragma once

#include <cstddef>

namespace coif::light {

/// `depths` holds `layers` layers of `width` optical depths each, in the light's order from layer `first` on,
/// wrapping. `out`, as large, becomes T = exp(−Σ) over the layers up to each, `depths` zero. `width` is a
/// multiple of 16; 1e-6 off at most. The same bytes for any number of lanes (4, 8 or 16; the processor has to
/// have them).
void transmittanceByColumns(float* depths, float* out, std::size_t width, std::size_t layers,
                            std::size_t first, int lanes);

}  // namespace coif::light
