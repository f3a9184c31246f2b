#include "coif/light/image.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "coif/base/random.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wsign-compare"
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STB_IMAGE_IMPLEMENTATION
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace coif {
namespace {

TEST(Png, ReadsBackAsWritten) {
  Image image{5, 3, {}};
  for (int i = 0; i < 60; ++i) image.rgba.push_back(std::uint8_t(mix64(std::uint64_t(i))));
  const auto png = encodePng(image);
  ASSERT_TRUE(png.ok());
  int width = 0, height = 0, channels = 0;
  stbi_uc* pixels = stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(png->data()), int(png->size()),
                                          &width, &height, &channels, 4);
  ASSERT_NE(pixels, nullptr);
  EXPECT_EQ(width, 5);
  EXPECT_EQ(height, 3);
  EXPECT_EQ(std::memcmp(pixels, image.rgba.data(), 60), 0);
  stbi_image_free(pixels);
  image.rgba.pop_back();
  EXPECT_FALSE(encodePng(image).ok());
  EXPECT_FALSE(encodePng(Image{}).ok());
}

FloatImage wideRange() {
  FloatImage image(37, 21);  // odd sizes: no block of the file is full
  for (std::size_t i = 0; i < image.rgba.size(); ++i) {
    const double u = CounterRandom(3, i).uniform(0);
    image.rgba[i] = i % 4 == 3 ? float(u) : float(std::exp(20 * (u - 0.5)));
  }
  return image;
}

TEST(Exr, FloatKeepsEveryBitAndTheAlpha) {
  const FloatImage image = wideRange();
  const auto bytes = encodeExr(image, ExrPrecision::Float);
  ASSERT_TRUE(bytes.ok());
  const auto back = decodeExr(*bytes);
  ASSERT_TRUE(back.ok()) << back.error().text();
  EXPECT_EQ(back->width, 37);
  EXPECT_EQ(back->height, 21);
  EXPECT_EQ(back->rgba, image.rgba);
}

TEST(Exr, HalfRoundsToElevenBits) {
  FloatImage image = wideRange();
  image.rgba[0] = 1e9f;
  const auto bytes = encodeExr(image);
  ASSERT_TRUE(bytes.ok());
  const auto back = decodeExr(*bytes);
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(back->rgba[0], 65504);
  for (std::size_t i = 1; i < image.rgba.size(); ++i) {
    // Half an ulp of 11 bits; below 2^-14 halves are spaced 2^-24.
    EXPECT_NEAR(back->rgba[i], image.rgba[i],
                std::max(image.rgba[i] * std::ldexp(1.0, -11), std::ldexp(1.0, -25)));
  }
}

TEST(Exr, DamagedBytesAreAnError) {
  const auto bytes = encodeExr(wideRange());
  ASSERT_TRUE(bytes.ok());
  EXPECT_FALSE(decodeExr({}).ok());
  for (const double part : {0.01, 0.1, 0.5, 0.99}) {
    EXPECT_FALSE(decodeExr(std::span(*bytes).first(std::size_t(part * double(bytes->size())))).ok()) << part;
  }
  EXPECT_FALSE(encodeExr(FloatImage{}).ok());
}

TEST(Srgb, EveryByteSurvivesThereAndBack) {
  Image image{256, 2, {}};
  for (int i = 0; i < 512; ++i) {
    const auto v = std::uint8_t(i % 256);
    image.rgba.insert(image.rgba.end(),
                      {v, std::uint8_t(255 - v), 7, std::uint8_t(i < 256 ? 255 : 1 + v / 2)});
  }
  EXPECT_EQ(toSrgb(toLinear(image)).rgba, image.rgba);
}

TEST(Srgb, MiddleGreyAlphaAndTheEnds) {
  FloatImage image(4, 1);
  const float pixels[] = {0.215861f, 2, -1, 1, 0.25f, 0.5f, 0, 0.5f, NAN, 0, 0, 1, 0.3f, 0.3f, 0.3f, 0};
  image.rgba.assign(pixels, pixels + 16);
  const Image out = toSrgb(image);
  EXPECT_EQ(out.rgba[0], 128);  // linear of 128
  EXPECT_EQ(out.rgba[1], 255);
  EXPECT_EQ(out.rgba[2], 0);
  EXPECT_EQ(out.rgba[4], 188);  // 0.25 over alpha 0.5 is 0.5 straight
  EXPECT_EQ(out.rgba[5], 255);
  EXPECT_EQ(out.rgba[7], 128);
  EXPECT_EQ(out.rgba[8], 0);
}

}  // namespace
}  // namespace coif
