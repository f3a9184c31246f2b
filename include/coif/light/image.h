// Pictures in memory, and as PNG and EXR.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "coif/base/result.h"
#include "coif/base/vec.h"

namespace coif {

/// 8-bit sRGB with straight alpha, rows from the top.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  ///< height × width × 4
};

/// Linear light (sRGB primaries) with premultiplied alpha, rows from the top. Values may exceed 1.
struct FloatImage {
  int width = 0, height = 0;
  std::vector<float> rgba;  ///< height × width × 4

  FloatImage() = default;
  FloatImage(int w, int h) : width(w), height(h), rgba(std::size_t(w) * std::size_t(h) * 4, 0.0f) {}
  float* at(int x, int y) { return rgba.data() + 4 * (std::size_t(y) * std::size_t(width) + std::size_t(x)); }
  const float* at(int x, int y) const { return const_cast<FloatImage*>(this)->at(x, y); }
};

/// Largest side that pictures are read, drawn and written at.
inline constexpr int kLargestPictureSide = 32768;
/// Refuses an empty picture, one whose values do not match its size, and one beyond kLargestPictureSide.
Status validate(const Image& image);
Status validate(const FloatImage& image);

/// The picture over a studio's backdrop, as the preview draws it (shaders/backdrop.frag): a gradient from
/// `top` to `bottom` with a soft glow behind the model, linear light. Alpha becomes 1.
FloatImage overBackdrop(const FloatImage& image, const Vec3f& top, const Vec3f& bottom);

/// The eye's picture: exposure 1 (linear 1 is white), clipped, sRGB's transfer curve and no other, rounded;
/// straight alpha. What is not a number becomes 0. An invalid picture gives an empty one.
Image toSrgb(const FloatImage& image);
/// Back: exact up to the rounding to 8 bits.
FloatImage toLinear(const Image& image);
/// Linear light of sRGB's transfer curve (IEC 61966-2-1), both in [0, 1], and its inverse.
double linearFromSrgb(double value);
double srgbFromLinear(double value);

/// The bytes of a PNG file (write them with io's SafeFile). Errors: InvalidArgument for an empty or mis-sized
/// image.
Result<std::vector<std::byte>> encodePng(const Image& image);

enum class ExrPrecision { Half, Float };
/// The bytes of an OpenEXR file: scan lines, ZIP, channels R, G, B, A, premultiplied. Half keeps 11 bits and
/// clips at 65504. Errors: InvalidArgument.
Result<std::vector<std::byte>> encodeExr(const FloatImage& image,
                                         ExrPrecision precision = ExrPrecision::Half);
/// Reads R, G, B and A (1 where the file has none) of the first part, its data window as the picture; grey Y
/// where there is no R. Errors: Malformed, TooLarge.
Result<FloatImage> decodeExr(std::span<const std::byte> bytes);

}  // namespace coif
