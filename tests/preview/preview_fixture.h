// One Preview for all tests of a program; tests skip where there is no OpenGL.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>

#include "coif/base/random.h"
#include "coif/preview/session.h"

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
  /// For many pictures of one scene: what does not change is made once.
  static PreviewSession sessionFor(const PreviewScene& scene) {
    PreviewSession session(*preview());
    const bool set = (scene.strands == nullptr || session.setStrands(*scene.strands).ok()) &&
                     (scene.head == nullptr || session.setHead(*scene.head).ok()) &&
                     session.setGround(scene.ground).ok();
    EXPECT_TRUE(set);
    session.setCamera(scene.camera);
    session.setLights(scene.lights);
    return session;
  }
  static Picture render(PreviewSession& session, const PreviewOptions& options) {
    Result<Picture> picture = session.render(options);
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

// Pixels with hair that are black, or far brighter than all around them.
inline int speckles(const Image& image) {
  const auto at = [&](int x, int y) { return &image.rgba[4 * std::size_t(y * image.width + x)]; };
  const auto light = [&](int x, int y) { return at(x, y)[0] + at(x, y)[1] + at(x, y)[2]; };
  int count = 0;
  for (int y = 1; y + 1 < image.height; ++y) {
    for (int x = 1; x + 1 < image.width; ++x) {
      if (at(x, y)[3] < 128) continue;
      int brightest = 0;
      for (int k = 0; k < 9; ++k) {
        const int dx = k % 3 - 1, dy = k / 3 - 1;
        if ((dx != 0 || dy != 0) && at(x + dx, y + dy)[3] > 64)
          brightest = std::max(brightest, light(x + dx, y + dy));
      }
      if (light(x, y) == 0 || (brightest > 0 && light(x, y) > 6 * brightest + 60)) ++count;
    }
  }
  return count;
}

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
