// How far two pictures are apart.
//
// Pictures are linear light, of the same size; alpha is ignored, so put both over the same background first.
// Errors: InvalidArgument for sizes that differ or an invalid picture, values that are not finite.
#pragma once

#include <vector>

#include "coif/base/context.h"
#include "coif/light/image.h"

namespace coif {

/// Mean of the squared differences over pixels and RGB.
Result<double> meanSquaredError(const FloatImage& image, const FloatImage& reference);

/// Mean over pixels and RGB of (image − reference)² / (reference² + epsilon). The default epsilon lets the
/// darkness below 0.1 count absolutely (as in Rousselle et al. 2011).
Result<double> relativeMse(const FloatImage& image, const FloatImage& reference, double epsilon = 0.01);

/// How different the eye finds two pictures that it sees in turn, in [0, 1].
struct Flip {
  double mean = 0;
  std::vector<float> map;  ///< height × width, rows from the top
};
/// ꟻLIP for pictures of low dynamic range: linear values are clipped to [0, 1], as a display does. Symmetric.
/// Accuracy: within 2e-5 of the published program's mean, which computes in float32, and 5e-4 of any pixel of
/// its map (tests). Cost: some 1.2 µs a pixel and thread; same bytes for any number of threads. Errors also:
/// Cancelled, pixelsPerDegree outside [4, 1000]. Source: Andersson, Nilsson, Akenine-Möller, Oskarsson,
/// Åström and Fairchild, "FLIP: A Difference Evaluator for Alternating Images", 2020; 67 pixels a degree: a
/// display 0.7 m wide of 3840 pixels, seen from 0.7 m.
Result<Flip> flip(const FloatImage& image, const FloatImage& reference, double pixelsPerDegree = 67,
                  const Context& context = {});

}  // namespace coif
