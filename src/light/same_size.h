// What every comparison of two pictures asks of them first.
#pragma once

#include "coif/light/image.h"

namespace coif {

/// Both valid, of one size, RGB finite.
Status checkComparable(const FloatImage& image, const FloatImage& reference);

}  // namespace coif
