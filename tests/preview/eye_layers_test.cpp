// Hair drawn by compute, in layers of depth: against areas, the sorted lists, and a head.
#include <algorithm>
#include <cmath>

#include "coif/light/image_metrics.h"
#include "coif/scalp/example_head.h"
#include "preview_fixture.h"

namespace coif {
namespace {

using testing::addStrand, testing::sceneOf, testing::tuft;
using EyeLayers = testing::PreviewTest;

// Looks along -z at the origin so that a pixel measures exactly 1 / 100 there.
Camera straightCamera(int height) {
  Camera camera;
  camera.eye = Vec3(0, 0, 10);
  camera.fovDeg = 2 * std::atan(0.5 * height / 100.0 / 10) * 180 / 3.14159265358979323846;
  return camera;
}

PreviewOptions layered(PreviewOptions options) {
  options.transparency = PreviewTransparency::DepthLayers;
  options.leaveOut = false;  // wide hairs too
  return options;
}

FloatImage over(const Image& image, float grey) {
  FloatImage out = toLinear(image);
  for (std::size_t i = 0; i < out.rgba.size(); i += 4) {
    for (std::size_t c = 0; c < 3; ++c) out.rgba[i + c] += (1 - out.rgba[i + 3]) * grey;
    out.rgba[i + 3] = 1;
  }
  return out;
}

TEST_F(EyeLayers, ALineCoversLengthTimesWidthAlongAnyDirection) {
  for (const double angle : {0.0, 0.2, 0.7, 1.3, 1.57079632679, 2.4}) {
    for (const float widthPx : {0.05f, 0.25f, 0.6f, 0.95f, 2.5f}) {
      StrandSet strands;
      const Vec3f along(0.5f * float(std::cos(angle)), 0.5f * float(std::sin(angle)), 0);
      addStrand(strands, {Vec3f(0.0031f, 0.0017f, 0) - along, Vec3f(0.0031f, 0.0017f, 0) + along},
                widthPx / 100);
      PreviewScene scene;
      scene.strands = &strands;
      scene.camera = straightCamera(256);
      // Optical depths are kept in 1/65536, a covered pixel is 0.999; 8-bit alpha rounds up to three pixels a
      // column by half a step at most, at random. At 45° a column's ends cut a wide ribbon askew.
      EXPECT_NEAR(alphaSum(render(scene, layered(small(256, 1))).image), 100 * widthPx,
                  0.35 + 0.006 * 100 * widthPx)
          << angle << ", " << widthPx << " pixels wide";
    }
  }
}

TEST_F(EyeLayers, LooksAsTheSortedListsDo) {
  for (const float width : {0.001f, 0.02f}) {
    const StrandSet strands = tuft(4000, width);
    PreviewOptions options = small(160, 16);
    options.leaveOut = false;
    options.shading = PreviewShading::DualScattering;
    options.transparency = PreviewTransparency::ExactLists;
    const Image truth = render(sceneOf(strands), options).image;
    options.subframes = 1;
    const Image layers = render(sceneOf(strands), layered(options)).image;
    // The lists blend lines of one pixel, the layers filter: thin hairs' light lies a little differently.
    EXPECT_NEAR(alphaSum(layers) / alphaSum(truth), 1, 0.02) << width;
    EXPECT_LT(flip(over(layers, 0.2f), over(truth, 0.2f))->mean, 0.04) << width;
  }
}

TEST_F(EyeLayers, ALayerInFrontHidesWhatIsBehindAndTheHeadHidesBoth) {
  StrandSet strands;
  const auto curtain = [&](float z, const Vec3f& color) {
    for (int i = 0; i < 200; ++i) {
      const float x = -0.4f + 0.8f * float(i) / 199;
      addStrand(strands, {Vec3f(x, -0.4f, z), Vec3f(x + 0.001f, 0.4f, z)}, 0.012f);
      strands.colors.resize(strands.points.size(), color);
    }
  };
  curtain(0, Vec3f(0.7f, 0.05f, 0.05f));
  curtain(-0.5f, Vec3f(0.05f, 0.05f, 0.7f));
  PreviewScene scene;
  scene.strands = &strands;
  scene.camera = straightCamera(128);
  PreviewOptions options = layered(small(128, 1));
  options.shadows = false;
  const FloatImage front = toLinear(render(scene, options).image);
  // The front curtain covers a pixel three times over and lets e^-3 of the other's light through; its own
  // blue is a fourteenth of its red, and white where it reflects.
  EXPECT_GT(front.at(64, 64)[0], 5 * front.at(64, 64)[2]);
  PolygonMesh wall;
  wall.positions = {{-1, -1, 0.3}, {1, -1, 0.3}, {1, 1, 0.3}, {-1, 1, 0.3}};
  wall.corners = {0, 1, 2, 3};
  wall.faceOffsets = {0, 4};
  scene.head = &wall;
  PreviewScene alone;
  alone.head = &wall;
  alone.camera = scene.camera;
  EXPECT_EQ(render(scene, options).image.rgba, render(alone, options).image.rgba);
}

TEST_F(EyeLayers, ManyHairsInOnePixelAddUpWithoutOverflow) {
  StrandSet strands;
  for (int i = 0; i < 20000; ++i) addStrand(strands, {Vec3f(-0.05f, 0, 0), Vec3f(0.05f, 1e-4f, 0)}, 0.05f);
  PreviewScene scene;
  scene.strands = &strands;
  scene.camera = straightCamera(64);
  PreviewOptions options = layered(small(64, 1));
  options.lod = false;
  options.shadows = false;
  const Image many = render(scene, options).image;
  strands.offsets.resize(2), strands.points.resize(2), strands.widths.resize(2);
  const Image one = render(scene, options).image;
  // The same hair again and again keeps its colour, whatever the sums are: 20000 × 6.9 × 65536 > 2 × 2³².
  int brightest = 0;
  for (std::size_t i = 0; i < many.rgba.size(); i += 4) {
    if (one.rgba[i + 3] < 250) continue;
    ++brightest;
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(many.rgba[i + c], one.rgba[i + c], 24);  // each hair's own tint
    EXPECT_EQ(many.rgba[i + 3], 255);
  }
  EXPECT_GT(brightest, 0);
}

TEST_F(EyeLayers, IsChosenWhereThereIsNoGpuAndHairIsThin) {
  const StrandSet thin = tuft(200, 0.001f), wide = tuft(200, 0.2f);
  PreviewOptions options = small(96, 1);
  options.leaveOut = false;
  const PreviewOptions asked = layered(options);
  const bool software = preview()->software();
  EXPECT_EQ(render(sceneOf(thin), options).image.rgba == render(sceneOf(thin), asked).image.rgba, software);
  EXPECT_NE(render(sceneOf(wide), options).image.rgba, render(sceneOf(wide), asked).image.rgba);
}

// Buffers hold 819 rows of this width where a storage block has 128 MiB: the picture is made in two parts.
TEST_F(EyeLayers, APictureOfManyRowsIsWhole) {
  const StrandSet strands = tuft(20000, 0.0012f);
  PolygonMesh head;
  head.positions = {{-0.1, 0.4, 0}, {0.1, 0.4, 0}, {0, 0.6, 0}};
  head.faceOffsets = {0, 3};
  head.corners = {0, 1, 2};
  PreviewScene scene = sceneOf(strands);
  scene.head = &head;
  scene.ground = Ground{Vec3(0, -0.1, 0), Vec3::UnitY(), 0.7, Vec3f::Constant(0.1f)};
  PreviewOptions options = small(1024, 1);
  options.transparency = PreviewTransparency::Stochastic;
  const Image truth = render(scene, options).image;
  options.transparency = PreviewTransparency::Auto;
  const Image image = render(scene, options).image;
  for (int band = 0; band < 8; ++band) {
    const auto covered = [&](const Image& picture) {
      double sum = 0;
      for (std::size_t i = std::size_t(band) * 128 * 1024; i < std::size_t(band + 1) * 128 * 1024; ++i)
        sum += picture.rgba[4 * i + 3] / 255.0;
      return sum;
    };
    // The truth is a random part of four samples a pixel: far below a hundredth over a band, and rims of the
    // tuft.
    EXPECT_NEAR(covered(image), covered(truth), 0.03 * covered(truth) + 20) << "rows " << 128 * band;
  }
}

}  // namespace
}  // namespace coif
