// A picture in memory and as PNG.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "coif/base/result.h"

namespace coif {

/// 8-bit sRGB with straight alpha, rows from the top.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  ///< height × width × 4
};

/// The bytes of a PNG file (write them with io's SafeFile). Errors: InvalidArgument for an empty or mis-sized
/// image.
Result<std::vector<std::byte>> encodePng(const Image& image);

}  // namespace coif
