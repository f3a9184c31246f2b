// One Preview for all tests of a program; tests skip where there is no OpenGL.
#pragma once

#include <gtest/gtest.h>

#include "coif/preview/preview.h"

namespace coif::testing {

class PreviewTest : public ::testing::Test {
 protected:
  static Preview* preview() {
    static Result<Preview> made = Preview::create();
    if (!made.ok()) reason() = made.error().text();
    return made.ok() ? &*made : nullptr;
  }
  static std::string& reason() {
    static std::string text;
    return text;
  }
  void SetUp() override {
    if (preview() == nullptr) GTEST_SKIP() << reason();
  }
  /// The picture; fails the test on an error.
  static Picture render(const PreviewScene& scene, const PreviewOptions& options,
                        const Context& context = {}) {
    Result<Picture> picture = preview()->render(scene, options, context);
    EXPECT_TRUE(picture.ok()) << picture.error().text();
    return picture.ok() ? *std::move(picture) : Picture{};
  }
  static double alphaSum(const Image& image) {
    double sum = 0;
    for (std::size_t i = 3; i < image.rgba.size(); i += 4) sum += image.rgba[i] / 255.0;
    return sum;
  }
  static PreviewOptions small(int size = 128, int subframes = 1) {
    PreviewOptions options;
    options.width = options.height = size;
    options.subframes = subframes;
    options.transparentBackground = true;
    return options;
  }
};

inline void addStrand(StrandSet& strands, std::initializer_list<Vec3f> points, float width) {
  strands.points.insert(strands.points.end(), points);
  strands.widths.resize(strands.points.size(), width);
  strands.offsets.push_back(strands.points.size());
}

}  // namespace coif::testing
