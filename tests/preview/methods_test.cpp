// Every way of shading, of shadows and of treating partial coverage gives a picture that can be true.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "preview_fixture.h"

namespace coif {
namespace {

using testing::sceneOf, testing::speckles, testing::tuft;
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
  PreviewSession session = sessionFor(sceneOf(strands));
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
      const Image image = render(session, options).image;
      EXPECT_GT(alphaSum(image), 500);
      EXPECT_GT(meanColor(image), 2) << int(shading) << " " << int(method);
      EXPECT_EQ(speckles(image), 0) << int(shading) << " " << int(method);
    }
  }
}

TEST_F(Methods, EveryShadowMethodDarkensTheHairAboutAsTheSortedListsDo) {
  const StrandSet strands = tuft(3000, 0.006f);
  PreviewOptions options = small(96, 2);
  PreviewSession session = sessionFor(sceneOf(strands));
  const auto brightness = [&](VisibilityMethod method) {
    options.visibility.method = method;
    return meanColor(render(session, options).image);
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

}  // namespace
}  // namespace coif
