// Hair, lights and fibres at their extremes: by every way of shadows and transparency the driver has nothing to
// complain of (an error of the picture), and no pixel is black or sticks out of those around it.
#include <cmath>
#include <functional>

#include "coif/preview/names.h"
#include "preview_fixture.h"

namespace coif {
namespace {

using testing::addStrand, testing::sceneOf, testing::speckles, testing::tuft;

class Extremes : public testing::PreviewTest {
 protected:
  // The sky lights every hair, the blackest too: black is what a value that is not a number leaves behind.
  static void expectClean(const Image& image, const std::string& what) {
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
      const std::uint8_t* p = &image.rgba[i];
      ASSERT_TRUE(p[3] <= 8 || p[0] + p[1] + p[2] > 0) << what << ", pixel " << i / 4;
    }
    EXPECT_EQ(speckles(image), 0) << what;
  }
  /// Every transparency with the default shadows, every shadow with the default transparency. `covered`: the
  /// least sum of alpha.
  static void expectCleanByEveryMethod(const PreviewScene& scene, PreviewOptions options, double covered,
                                       const std::string& what) {
    options.shading = PreviewShading::DualScattering;
    options.leaveOut = false;  // each method has to stand it
    options.visibility.slices = 32;
    PreviewSession session = sessionFor(scene);
    for (const char* word : transparencyNames()) {
      ASSERT_TRUE(setTransparency(options, word).ok());
      const Image image = render(session, options).image;
      EXPECT_GE(alphaSum(image), covered) << what << ", " << word;
      expectClean(image, what + ", " + word);
    }
    options.transparency = PreviewTransparency::Auto;
    for (const char* word : visibilityNames()) {
      ASSERT_TRUE(setVisibility(options, word).ok());
      expectClean(render(session, options).image, what + ", " + word);
    }
  }
};

TEST_F(Extremes, OneStrand) {
  StrandSet one;
  addStrand(one, {Vec3f(-0.4f, 0.2f, 0), Vec3f(0.4f, 0.5f, 0)}, 0.02f);
  expectCleanByEveryMethod(sceneOf(one), small(48), 5, "one strand");
}

TEST_F(Extremes, HairsThatCoverAllOrNextToNothingOfAPixel) {
  StrandSet wide, thin;
  for (int i = 0; i < 300; ++i) {
    const Vec3f a(-0.4f, 0.003f * float(i), 0.001f * float(i % 7)), b(0.4f, 0.3f, 0.1f);
    addStrand(wide, {a, b}, 0.5f);
    addStrand(thin, {a, b}, 4e-8f);  // a millionth of a pixel
  }
  PreviewOptions options = small(48);
  options.lod = false;
  expectCleanByEveryMethod(sceneOf(wide), options, 200, "alpha 1");
  expectCleanByEveryMethod(sceneOf(thin), options, 0, "alpha 1e-6");
}

TEST_F(Extremes, StrandsOfOneIdAreNotJoined) {
  StrandSet strands;
  for (const float y : {0.1f, 0.3f, 0.5f, 0.7f}) addStrand(strands, {Vec3f(-0.4f, y, 0), Vec3f(0.4f, y, 0)}, 0.01f);
  PreviewOptions options = small(96);
  options.shadows = false;
  options.transparency = PreviewTransparency::DepthLayers;
  const double apart = alphaSum(render(sceneOf(strands), options).image);
  strands.ids.assign(4, 7);
  EXPECT_NEAR(alphaSum(render(sceneOf(strands), options).image), apart, 1e-3 * apart);
}

TEST_F(Extremes, NoWidth) {
  StrandSet none;
  for (int i = 0; i < 20; ++i) addStrand(none, {Vec3f(-0.4f, 0.02f * float(i), 0), Vec3f(0.4f, 0.3f, 0)}, 0);
  expectCleanByEveryMethod(sceneOf(none), small(32), 0, "no width");
}

TEST_F(Extremes, HairFarLongerThanThePictureAndItsMap) {
  StrandSet strands;
  addStrand(strands, {Vec3f(-500, 0.5f, 0), Vec3f(500, 0.5f, 0.1f)}, 0.05f);
  addStrand(strands, {Vec3f(0, -500, 0), Vec3f(0.1f, 500, 0)}, 0.05f);
  addStrand(strands, {Vec3f(0, 0.3f, -500), Vec3f(0, 0.3f, 500)}, 0.05f);
  expectCleanByEveryMethod(sceneOf(strands), small(48), 20, "long hair");
}

TEST_F(Extremes, ACameraInsideTheHair) {
  const StrandSet strands = tuft(1500, 0.01f);
  PreviewScene scene = sceneOf(strands);
  scene.camera.eye = Vec3(0.02, 0.3, 0.01);
  scene.camera.target = Vec3(1, 0.4, 0.2);
  expectCleanByEveryMethod(scene, small(48), 200, "camera inside");
}

TEST_F(Extremes, AllStrandsInOneTexelShadeEachOther) {
  StrandSet strands;  // a bundle towards the light, seen from the side
  for (int i = 0; i < 3000; ++i) addStrand(strands, {Vec3f(0, 0, 0), Vec3f(1e-4f, 1, 0)}, 0.02f);
  addStrand(strands, {Vec3f(-0.5f, 0, 0), Vec3f(-0.5f, 0.01f, 0)}, 0.02f);  // so that the map is not one texel
  PreviewScene scene;
  scene.strands = &strands;
  scene.camera = frameBox({Vec3(-0.5, 0, -0.1), Vec3(0.5, 1, 0.1)}, UpAxis::Y, 0, 0);
  scene.lights.followCamera = false;
  scene.lights.key.direction = Vec3(0, 1, 0.02);
  PreviewOptions options = small(64);
  options.lod = false;
  expectCleanByEveryMethod(scene, options, 20, "one texel");
}

TEST_F(Extremes, ExtremeFibresAndLightsGiveFinitePictures) {
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
        expectClean(image, std::to_string(grazing) + "° " + std::to_string(roughness) + " " +
                               std::to_string(absorption));
      }
    }
  }
}

}  // namespace
}  // namespace coif
