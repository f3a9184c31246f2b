#include "coif/light/image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wunused-function"
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace coif {
namespace {

Status checkSize(int width, int height, std::size_t values) {
  if (width <= 0 || height <= 0 || values != std::size_t(width) * std::size_t(height) * 4) {
    return makeError(ErrorCode::InvalidArgument, "the image is empty or its bytes do not match its size");
  }
  if (width > kLargestPictureSide || height > kLargestPictureSide) {
    return makeError(ErrorCode::InvalidArgument,
                     "the image has more than " + std::to_string(kLargestPictureSide) + " pixels a side");
  }
  return {};
}

std::uint8_t toByte(double value) {
  return std::uint8_t(std::lround(255 * std::clamp(std::isnan(value) ? 0.0 : value, 0.0, 1.0)));
}

}  // namespace

Status validate(const Image& image) {
  return checkSize(image.width, image.height, image.rgba.size());
}
Status validate(const FloatImage& image) {
  return checkSize(image.width, image.height, image.rgba.size());
}

double linearFromSrgb(double value) {
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}
double srgbFromLinear(double value) {
  return value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1 / 2.4) - 0.055;
}

FloatImage overBackdrop(const FloatImage& image, const Vec3f& top, const Vec3f& bottom) {
  FloatImage out = image;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const double u = (x + 0.5) / image.width, v = 1 - (y + 0.5) / image.height;
      const double dx = (u - 0.5) * image.width / image.height, dy = v - 0.55;
      const double s = std::clamp(0.35 * v + 0.65 * std::exp(-2.8 * (dx * dx + dy * dy)), 0.0, 1.0);
      const float t = float(s * s * (3 - 2 * s));
      float* pixel = out.at(x, y);
      for (int c = 0; c < 3; ++c) pixel[c] += (1 - pixel[3]) * (bottom[c] + t * (top[c] - bottom[c]));
      pixel[3] = 1;
    }
  }
  return out;
}

Image toSrgb(const FloatImage& image) {
  if (!validate(image).ok()) return {};
  Image result{image.width, image.height, std::vector<std::uint8_t>(image.rgba.size())};
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    const double alpha = image.rgba[i + 3];
    for (std::size_t c = 0; c < 3; ++c) {
      const double straight = alpha > 0 ? image.rgba[i + c] / alpha : image.rgba[i + c];
      result.rgba[i + c] = toByte(straight > 0 ? srgbFromLinear(std::min(straight, 1.0)) : 0.0);
    }
    result.rgba[i + 3] = toByte(alpha);
  }
  return result;
}

FloatImage toLinear(const Image& image) {
  if (!validate(image).ok()) return {};
  std::array<double, 256> linear;
  for (std::size_t v = 0; v < linear.size(); ++v) linear[v] = linearFromSrgb(double(v) / 255);
  FloatImage result(image.width, image.height);
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    const double alpha = image.rgba[i + 3] / 255.0;
    for (std::size_t c = 0; c < 3; ++c) result.rgba[i + c] = float(linear[image.rgba[i + c]] * alpha);
    result.rgba[i + 3] = float(alpha);
  }
  return result;
}

Result<std::vector<std::byte>> encodePng(const Image& image) {
  COIF_TRY(validate(image));
  std::vector<std::byte> bytes;
  const auto append = [](void* context, void* data, int size) {
    auto& out = *static_cast<std::vector<std::byte>*>(context);
    const auto* first = static_cast<const std::byte*>(data);
    out.insert(out.end(), first, first + size);
  };
  if (!stbi_write_png_to_func(append, &bytes, image.width, image.height, 4, image.rgba.data(),
                              image.width * 4)) {
    return makeError(ErrorCode::TooLarge, "the image could not be encoded as PNG");
  }
  return bytes;
}

}  // namespace coif
