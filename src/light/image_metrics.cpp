#include "coif/light/image_metrics.h"

#include <cmath>

#include "light/same_size.h"

namespace coif {
namespace {

// Mean of term(a, b) over RGB, rows summed apart: small values are not lost in a large picture's sum.
template <class Term>
double meanOverRgb(const FloatImage& a, const FloatImage& b, Term term) {
  double total = 0;
  for (int y = 0; y < a.height; ++y) {
    double row = 0;
    for (int x = 0; x < a.width; ++x) {
      for (int c = 0; c < 3; ++c) row += term(double(a.at(x, y)[c]), double(b.at(x, y)[c]));
    }
    total += row;
  }
  return total / (3.0 * a.width * a.height);
}

}  // namespace

Status checkComparable(const FloatImage& image, const FloatImage& reference) {
  COIF_TRY(validate(image));
  COIF_TRY(validate(reference));
  if (image.width != reference.width || image.height != reference.height) {
    return makeError(ErrorCode::InvalidArgument, "the pictures to compare differ in size");
  }
  for (const FloatImage* picture : {&image, &reference}) {
    for (std::size_t i = 0; i < picture->rgba.size(); ++i) {
      if (i % 4 != 3 && !std::isfinite(picture->rgba[i])) {
        return makeError(ErrorCode::InvalidArgument, "a picture to compare has a value that is not finite",
                         "pixel " + std::to_string(i / 4));
      }
    }
  }
  return {};
}

Result<double> meanSquaredError(const FloatImage& image, const FloatImage& reference) {
  COIF_TRY(checkComparable(image, reference));
  return meanOverRgb(image, reference, [](double a, double b) { return (a - b) * (a - b); });
}

Result<double> relativeMse(const FloatImage& image, const FloatImage& reference, double epsilon) {
  COIF_TRY(checkComparable(image, reference));
  if (!(epsilon > 0)) return makeError(ErrorCode::InvalidArgument, "epsilon must be positive");
  return meanOverRgb(image, reference,
                     [&](double a, double b) { return (a - b) * (a - b) / (b * b + epsilon); });
}

}  // namespace coif
