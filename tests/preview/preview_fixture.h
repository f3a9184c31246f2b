// One Preview for all tests of a program; tests skip where there is no OpenGL.
#pragma once

#include <gtest/gtest.h>

#include "coif/base/random.h"
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

/// Leaning hairs on a square of one, and a camera that frames them.
inline StrandSet tuft(std::size_t count, float width) {
  StrandSet strands;
  for (std::size_t s = 0; s < count; ++s) {
    const CounterRandom random(3, s);
    const Vec3f root(float(random.uniform(0)) - 0.5f, float(random.uniform(1)) * 0.2f,
                     float(random.uniform(2)) - 0.5f);
    const Vec3f lean(0.2f * float(random.uniform(3)), 0.3f, 0.1f);
    addStrand(strands, {root, root + lean, root + 2.0f * lean + Vec3f(0.1f, 0, 0)}, width);
  }
  return strands;
}

inline PreviewScene sceneOf(const StrandSet& strands) {
  PreviewScene scene;
  scene.strands = &strands;
  scene.camera = frameBox({Vec3(-0.6, 0, -0.6), Vec3(0.8, 1, 0.8)}, UpAxis::Y, 20, 10);
  return scene;
}

}  // namespace coif::testing
