// Every way of shading, of shadows and of treating partial coverage gives a picture that can be true.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "preview_fixture.h"

namespace coif {
namespace {

using testing::addStrand, testing::sceneOf, testing::tuft;
using Methods = testing::PreviewTest;

double meanColor(const Image& image) {
  double sum = 0, weight = 0;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    const double a = image.rgba[i + 3];
    sum += a * (image.rgba[i] + image.rgba[i + 1] + image.rgba[i + 2]) / 3;
    weight += a;
  }
  return weight > 0 ? sum / weight : 0;
}

// Pixels with hair that are black, or far brighter than all around them.
int speckles(const Image& image) {
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

TEST_F(Methods, EveryTransparencyCoversAndColoursAsTheSortedListsDo) {
  const StrandSet strands = tuft(3000, 0.004f);
  PreviewOptions options = small(160, 16);
  options.transparency = PreviewTransparency::ExactLists;
  const Image truth = render(sceneOf(strands), options).image;
  ASSERT_GT(alphaSum(truth), 1000);
  for (const PreviewTransparency method :
       {PreviewTransparency::Stochastic, PreviewTransparency::AlphaToCoverage,
        PreviewTransparency::WeightedAverage, PreviewTransparency::OccupancyOrdered,
        PreviewTransparency::DepthLayers}) {
    options.transparency = method;
    const Image image = render(sceneOf(strands), options).image;
    EXPECT_NEAR(alphaSum(image) / alphaSum(truth), 1, 0.02) << int(method);
    // The weighted average knows no order; samples are compressed before their mean is taken (resolve.frag).
    EXPECT_NEAR(meanColor(image) / meanColor(truth), 1, 0.15) << int(method);
    EXPECT_EQ(speckles(image), 0) << int(method);
  }
}

// Light and eye on one side, and on opposite sides; the truth has sorted lists for both.
TEST_F(Methods, HalfAngleSlicesComeToTheSortedListsAsTheyGetThinner) {
  const StrandSet strands = tuft(3000, 0.004f);
  for (const double front : {1.0, -1.0}) {
    PreviewScene scene = sceneOf(strands);
    scene.lights.key.direction = Vec3(0.3, 0.5, front);
    scene.lights.fill.color = scene.lights.rim.color = Vec3f::Zero();
    scene.lights.skyColor = scene.lights.groundColor = Vec3f::Zero();
    PreviewOptions options = small(160, 4);
    options.shading = PreviewShading::KajiyaKay;
    options.hairColor = Vec3f(0.6f, 0.4f, 0.2f);
    options.transparency = PreviewTransparency::ExactLists;
    options.visibility.method = VisibilityMethod::Exact;
    const Image truth = render(scene, options).image;
    options.transparency = PreviewTransparency::HalfAngleSlices;
    const auto sliced = [&](int slices) {
      options.halfAngleSlices = slices;
      return render(scene, options);
    };
    const auto difference = [&](const Image& image) {
      double sum = 0;
      for (std::size_t i = 0; i < truth.rgba.size(); i += 4) {
        for (std::size_t c = 0; c < 3; ++c)
          sum += std::abs(image.rgba[i + c] * double(image.rgba[i + 3]) -
                          truth.rgba[i + c] * double(truth.rgba[i + 3]));
      }
      return sum;
    };
    const Picture fine = sliced(256);
    EXPECT_NEAR(alphaSum(fine.image) / alphaSum(truth), 1, 0.01) << "nothing is lost or drawn twice";
    EXPECT_NEAR(meanColor(fine.image) / meanColor(truth), 1, 0.1);
    const double coarse = difference(sliced(4).image), finer = difference(sliced(32).image),
                 finest = difference(fine.image);
    EXPECT_LT(finer, 0.7 * coarse);
    EXPECT_LE(finest, 1.02 * finer);
    EXPECT_EQ(sliced(32).image.rgba, sliced(32).image.rgba) << "the same bytes every time";
    const auto said = std::ranges::find(fine.stages, std::string("half-angle slices"), &StageReport::name);
    ASSERT_NE(said, fine.stages.end());
    EXPECT_NE(said->notes.front().find(front > 0 ? "front to back" : "back to front"), std::string::npos);
  }
}

TEST_F(Methods, EveryShadingAndShadowIsFreeOfSpeckle) {
  const StrandSet strands = tuft(3000, 0.006f);
  for (const PreviewShading shading : {PreviewShading::Studio, PreviewShading::KajiyaKay,
                                       PreviewShading::Marschner, PreviewShading::DualScattering}) {
    for (const VisibilityMethod method :
         {VisibilityMethod::None, VisibilityMethod::Opacity, VisibilityMethod::DensityClustering,
          VisibilityMethod::LightMap, VisibilityMethod::DeepOpacity, VisibilityMethod::Occupancy,
          VisibilityMethod::Exact}) {
      PreviewOptions options = small(96, 2);
      options.shading = shading;
      options.hairColor = Vec3f(0.6f, 0.4f, 0.2f);
      options.visibility.method = method;
      options.visibility.slices = 32;
      const Image image = render(sceneOf(strands), options).image;
      EXPECT_GT(alphaSum(image), 500);
      EXPECT_GT(meanColor(image), 2) << int(shading) << " " << int(method);
      EXPECT_EQ(speckles(image), 0) << int(shading) << " " << int(method);
    }
  }
}

TEST_F(Methods, EveryShadowMethodDarkensTheHairAboutAsTheSortedListsDo) {
  const StrandSet strands = tuft(3000, 0.006f);
  PreviewOptions options = small(96, 2);
  const auto brightness = [&](VisibilityMethod method) {
    options.visibility.method = method;
    return meanColor(render(sceneOf(strands), options).image);
  };
  const double lit = brightness(VisibilityMethod::None), truth = brightness(VisibilityMethod::Exact);
  ASSERT_LT(truth, 0.95 * lit);
  for (const VisibilityMethod method :
       {VisibilityMethod::Opacity, VisibilityMethod::DensityClustering, VisibilityMethod::LightMap,
        VisibilityMethod::DeepOpacity, VisibilityMethod::Occupancy}) {
    // A method that does nothing is off by all that the shadow takes away. The light map is the coarsest, a
    // grid of some dozens of cells a side: 0.59 measured, the others below 0.5.
    const double part = method == VisibilityMethod::LightMap ? 0.75 : 0.5;
    EXPECT_NEAR(brightness(method), truth, part * (lit - truth)) << name(method);
  }
}

TEST_F(Methods, ExtremeFibresAndLightsGiveFinitePictures) {
  const StrandSet strands = tuft(1500, 0.006f);
  PreviewScene scene = sceneOf(strands);
  scene.lights.followCamera = false;
  for (const double grazing : {90.0, 89.9, 0.0}) {  // between the key light and the first strand's normal plane
    const Vec3 along = (strands.points[1] - strands.points[0]).cast<double>().normalized();
    const double angle = grazing * 3.14159265358979323846 / 180;
    scene.lights.key.direction = std::sin(angle) * along + std::cos(angle) * along.unitOrthogonal();
    for (const double roughness : {1e-3, 1.0}) {
      for (const double absorption : {0.0, 1e4}) {
        PreviewOptions options = small(64, 1);
        options.shading = PreviewShading::DualScattering;
        options.useAbsorption = true;
        options.fibre.absorption = Vec3::Constant(absorption);
        options.fibre.longitudinalRoughness = options.fibre.azimuthalRoughness = roughness;
        const Image image = render(scene, options).image;
        EXPECT_GT(alphaSum(image), 200);
        // Even the blackest hair reflects some of the sky: black is what a value that is not a number leaves.
        for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
          const std::uint8_t* p = &image.rgba[i];
          ASSERT_TRUE(p[3] <= 8 || p[0] + p[1] + p[2] > 0) << grazing << " " << roughness << " " << absorption;
        }
        EXPECT_EQ(speckles(image), 0) << grazing << " " << roughness << " " << absorption;
      }
    }
  }
}

TEST_F(Methods, AllStrandsInOneTexelOfTheMapShadeEachOther) {
  StrandSet strands;  // a bundle towards the light, seen from the side
  for (int i = 0; i < 3000; ++i) addStrand(strands, {Vec3f(0, 0, 0), Vec3f(1e-4f, 1, 0)}, 0.02f);
  addStrand(strands, {Vec3f(-0.5f, 0, 0), Vec3f(-0.5f, 0.01f, 0)}, 0.02f);  // so that the map is not one texel
  PreviewScene scene;
  scene.strands = &strands;
  scene.camera = frameBox({Vec3(-0.5, 0, -0.1), Vec3(0.5, 1, 0.1)}, UpAxis::Y, 0, 0);
  scene.lights.followCamera = false;
  scene.lights.key.direction = Vec3(0, 1, 0.02);
  for (const VisibilityMethod method : {VisibilityMethod::DeepOpacity, VisibilityMethod::Occupancy,
                                        VisibilityMethod::DensityClustering, VisibilityMethod::Exact}) {
    PreviewOptions options = small(96, 1);
    options.shading = PreviewShading::DualScattering;
    options.visibility.method = method;
    options.lod = false;
    const Image image = render(scene, options).image;
    EXPECT_GT(alphaSum(image), 50);
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
      const std::uint8_t* p = &image.rgba[i];
      ASSERT_TRUE(p[3] <= 8 || p[0] + p[1] + p[2] > 0) << name(method);
    }
  }
}

TEST_F(Methods, ExtremeHairLeavesNoBlackPixel) {
  StrandSet one, line, tiny, inside;
  addStrand(one, {Vec3f(-0.4f, 0.2f, 0), Vec3f(0.4f, 0.5f, 0)}, 0.02f);
  for (int i = 0; i < 500; ++i) addStrand(line, {Vec3f(0, 0.5f, -0.5f), Vec3f(0, 0.5f, 0.5f)}, 0.02f);
  for (int i = 0; i < 500; ++i) addStrand(tiny, {Vec3f(-0.4f, 0.01f * i, 0), Vec3f(0.4f, 0.3f, 0)}, 1e-8f);
  addStrand(inside, {Vec3f(-50, 0.5f, 0), Vec3f(50, 0.5f, 0.1f)}, 0.05f);
  addStrand(inside, {Vec3f(0, -50, 0), Vec3f(0.1f, 50, 0)}, 0.05f);
  for (const StrandSet* strands : {&one, &line, &tiny, &inside}) {
    for (const PreviewTransparency transparency :
         {PreviewTransparency::Opaque, PreviewTransparency::WeightedAverage,
          PreviewTransparency::OccupancyOrdered, PreviewTransparency::DepthLayers,
          PreviewTransparency::ExactLists}) {
      PreviewOptions options = small(64, 1);
      options.shading = PreviewShading::DualScattering;
      options.transparency = transparency;
      const Image image = render(sceneOf(*strands), options).image;
      // The sky lights every hair, so black is what a value that is not a number leaves behind.
      for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
        const std::uint8_t* p = &image.rgba[i];
        ASSERT_TRUE(p[3] <= 8 || p[0] + p[1] + p[2] > 0) << int(transparency);
      }
    }
  }
}

}  // namespace
}  // namespace coif
