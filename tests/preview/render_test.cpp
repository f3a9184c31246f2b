#include <cmath>
#include <cstdlib>
#include <limits>

#include "coif/base/random.h"
#include "coif/scalp/example_head.h"
#include "preview_fixture.h"

namespace coif {
namespace {

using testing::addStrand;
using Rendering = testing::PreviewTest;

// Looks along -z at the origin so that a pixel measures exactly 1 / 100 there.
Camera straightCamera(int height) {
  Camera camera;
  camera.eye = Vec3(0, 0, 10);
  camera.fovDeg = 2 * std::atan(0.5 * height / 100.0 / 10) * 180 / 3.14159265358979323846;
  return camera;
}

StrandSet fur(std::size_t count) {
  StrandSet strands;
  for (std::size_t s = 0; s < count; ++s) {
    const CounterRandom random(3, s);
    const Vec3f root(float(random.uniform(0)) - 0.5f, float(random.uniform(1)) * 0.2f,
                     float(random.uniform(2)) - 0.5f);
    const Vec3f lean(0.2f * float(random.uniform(3)), 0.3f, 0.1f);
    addStrand(strands, {root, root + lean, root + 2.0f * lean + Vec3f(0.1f, 0, 0)}, 0.01f);
  }
  return strands;
}

TEST_F(Rendering, ALineCoversLengthTimesWidthAlongAnyDirection) {
  // Along an axis Mesa 22.3 would draw half of a line: it gets ribbons.
  for (const double angle : {0.0, 0.2, 0.7, 1.3, 1.57079632679, 2.4}) {
    for (const float widthPx : {0.25f, 0.6f, 0.95f}) {
      StrandSet strands;
      const Vec3f along(0.5f * float(std::cos(angle)), 0.5f * float(std::sin(angle)), 0);
      addStrand(strands, {-along, along}, widthPx / 100);
      PreviewScene scene;
      scene.strands = &strands;
      scene.camera = straightCamera(256);
      PreviewOptions options = small(256, 64);
      options.transparency = PreviewTransparency::Stochastic;
      const double lines = alphaSum(render(scene, options).image);
      EXPECT_NEAR(lines, 100 * widthPx, 0.8 + 0.02 * 100 * widthPx)
          << angle << ", " << widthPx << " pixels wide";
    }
  }
}

TEST_F(Rendering, AHorizontalRibbonCoversLengthTimesWidth) {
  for (const float widthPx : {0.25f, 0.6f, 1.0f, 3.0f, 12.5f}) {
    StrandSet strands;
    addStrand(strands, {Vec3f(-0.5f, 0.003f, 0), Vec3f(0.5f, 0.003f, 0)}, widthPx / 100);
    PreviewScene scene;
    scene.strands = &strands;
    scene.camera = straightCamera(256);
    PreviewOptions options = small(256, 64);
    options.lines = false;
    options.transparency = PreviewTransparency::Stochastic;
    const Picture picture = render(scene, options);
    // 256 samples a pixel: an edge is known to 1/256 of its length, 0.4 px each; 8-bit alpha adds half a step
    // a pixel; a mask chosen at random, 64 times in each of 100 pixels of a row, has a relative deviation
    // below 1 %.
    EXPECT_NEAR(alphaSum(picture.image), 100 * widthPx, 0.8 + 0.02 * 100 * widthPx)
        << widthPx << " pixels wide";
  }
}

TEST_F(Rendering, TheHeadIsThereAndMirrorsWithItsCamera) {
  const PolygonMesh head = makeExampleHead();
  PreviewScene scene;
  scene.head = &head;
  PreviewOptions options = small(192, 1);
  const auto view = [&](double azimuth) {
    scene.camera = frameBox(bounds(head.positions), UpAxis::Y, azimuth, 5);
    scene.lights = Lights{};
    if (azimuth < 0) {
      for (Light* light : {&scene.lights.key, &scene.lights.fill, &scene.lights.rim})
        light->direction.x() *= -1;
    }
    return render(scene, options).image;
  };
  const Image left = view(35), right = view(-35);
  EXPECT_GT(alphaSum(left), 0.2 * 192 * 192);
  EXPECT_LT(alphaSum(left), 0.8 * 192 * 192);
  double mirrored = 0, plain = 0;
  for (int y = 0; y < 192; ++y) {
    for (int x = 0; x < 192; ++x) {
      for (int c = 0; c < 4; ++c) {
        const int a = left.rgba[4 * (192 * y + x) + c];
        mirrored += std::abs(a - right.rgba[4 * (192 * y + 191 - x) + c]);
        plain += std::abs(a - right.rgba[4 * (192 * y + x) + c]);
      }
    }
  }
  // The four samples of a pixel are not mirrored, nor is the shadow map's grid: silhouettes and shadow edges
  // differ.
  EXPECT_LT(mirrored / (192 * 192 * 4), 1.5);
  EXPECT_GT(plain, 5 * mirrored);
}

TEST_F(Rendering, TheSamePictureHasTheSameBytes) {
  const StrandSet strands = fur(3000);
  const PolygonMesh head = makeExampleHead(16);
  PreviewScene scene;
  scene.strands = &strands;
  scene.camera = frameBox({Vec3(-0.6, 0, -0.6), Vec3(0.8, 1, 0.8)}, UpAxis::Y, 20, 20);
  Context one;
  one.threads = 1;
  const Image first = render(scene, small(160, 2)).image, second = render(scene, small(160, 2)).image;
  EXPECT_EQ(first.rgba, second.rgba);
  EXPECT_EQ(first.rgba, render(scene, small(160, 2), one).image.rgba);
  EXPECT_GT(alphaSum(first), 1000);
}

TEST_F(Rendering, HairShadesItself) {
  // A dense tuft: with shadows the mean brightness falls, and the lower half falls more than the upper.
  const StrandSet strands = fur(6000);
  PreviewScene scene;
  scene.strands = &strands;
  scene.camera = frameBox({Vec3(-0.6, 0, -0.6), Vec3(0.8, 1, 0.8)}, UpAxis::Y, 20, 5);
  PreviewOptions options = small(160, 2);
  const auto halves = [&](const Image& image) {
    double sum[2] = {0, 0}, count[2] = {0, 0};
    for (int y = 0; y < 160; ++y) {
      for (int x = 0; x < 160; ++x) {
        const std::uint8_t* p = &image.rgba[4 * (160 * y + x)];
        sum[y / 95] += p[1] * p[3] / 255.0;
        count[y / 95] += p[3] / 255.0;
      }
    }
    return std::pair(sum[0] / count[0], sum[1] / count[1]);
  };
  const auto shaded = halves(render(scene, options).image);
  options.shadows = false;
  const auto plain = halves(render(scene, options).image);
  EXPECT_LT(shaded.first, plain.first);
  EXPECT_LT(shaded.second, 0.8 * plain.second);
  EXPECT_LT(shaded.second / plain.second, shaded.first / plain.first);
}

TEST_F(Rendering, NoValueIsLostToDegenerateStrands) {
  StrandSet strands;
  addStrand(strands, {Vec3f(0, 0, 0), Vec3f(0, 0, 5)}, 0.05f);                       // towards the eye
  addStrand(strands, {Vec3f(0, 0, 9.5f), Vec3f(0, 0, 10), Vec3f(0, 0, 11)}, 0.05f);  // through the eye
  addStrand(strands, {Vec3f(0.2f, 0, 0), Vec3f(0.2f, 0, 0), Vec3f(0.2f, 0, 0)}, 0.05f);
  addStrand(strands, {Vec3f(-0.5f, 0, 0), Vec3f(-0.5f, 0, 0), Vec3f(0.5f, 0.3f, 0)}, 0.05f);
  addStrand(strands, {Vec3f(-0.5f, 0.1f, 0), Vec3f(0.5f, 0.1f, 0)}, 1e-30f);
  addStrand(strands, {Vec3f(-0.5f, -0.1f, 0), Vec3f(0.5f, -0.1f, 1e-30f)}, 0.02f);
  PreviewScene scene;
  scene.strands = &strands;
  scene.camera = straightCamera(128);
  for (const bool shadows : {true, false}) {
    PreviewOptions options = small(128, 4);
    options.shadows = shadows;
    const Picture picture = render(scene, options);
    EXPECT_EQ(picture.strandsDropped, 0u);
    EXPECT_GT(alphaSum(picture.image), 200);
    // The sky lights every hair, so black is what a value that is not a number leaves behind.
    for (std::size_t i = 0; i < picture.image.rgba.size(); i += 4) {
      const std::uint8_t* p = &picture.image.rgba[i];
      ASSERT_TRUE(p[3] <= 8 || p[0] + p[1] + p[2] > 0) << "pixel " << i / 4;
    }
  }
}

TEST_F(Rendering, BadStrandsAreLeftOutAndCounted) {
  StrandSet strands;
  addStrand(strands, {Vec3f(-0.5f, 0, 0), Vec3f(0.5f, 0, 0)}, 0.05f);
  const double alone = [&] {
    PreviewScene scene;
    scene.strands = &strands;
    scene.camera = straightCamera(128);
    return alphaSum(render(scene, small()).image);
  }();
  addStrand(strands, {Vec3f(0, 0, 0), Vec3f(std::numeric_limits<float>::quiet_NaN(), 1, 0)}, 0.05f);
  addStrand(strands, {Vec3f(0, 0, 0), Vec3f(0, std::numeric_limits<float>::infinity(), 0)}, 0.05f);
  addStrand(strands, {Vec3f(0, 0.2f, 0)}, 0.05f);
  PreviewScene scene;
  scene.strands = &strands;
  scene.camera = straightCamera(128);
  const Picture picture = render(scene, small());
  EXPECT_EQ(picture.strandsDrawn, 1u);
  EXPECT_EQ(picture.strandsDropped, 3u);
  EXPECT_EQ(picture.notes.size(), 1u);
  EXPECT_DOUBLE_EQ(alphaSum(picture.image), alone);
}

TEST_F(Rendering, NothingAndZeroWidthCoverNothing) {
  PreviewScene scene;
  scene.camera = straightCamera(64);
  EXPECT_EQ(alphaSum(render(scene, small(64)).image), 0);
  StrandSet strands;
  scene.strands = &strands;
  EXPECT_EQ(alphaSum(render(scene, small(64)).image), 0);
  addStrand(strands, {Vec3f(-0.5f, 0, 0), Vec3f(0.5f, 0, 0)}, 0);
  EXPECT_EQ(alphaSum(render(scene, small(64)).image), 0);
  const PolygonMesh empty;
  scene.head = &empty;
  EXPECT_EQ(alphaSum(render(scene, small(64)).image), 0);
}

TEST_F(Rendering, ACameraInsideTheHairIsFine) {
  const StrandSet strands = fur(2000);
  PreviewScene scene;
  scene.strands = &strands;
  scene.camera.eye = Vec3(0.02, 0.3, 0.01);
  scene.camera.target = Vec3(1, 0.4, 0.2);
  EXPECT_GT(alphaSum(render(scene, small()).image), 500);
}

TEST_F(Rendering, TheBackdropIsTheOneThatTracedPicturesGet) {
  PreviewOptions options = small(96, 1);
  options.height = 64;
  options.transparentBackground = false;
  const Image drawn = render({}, options).image;
  FloatImage backdrop = overBackdrop(FloatImage(options.width, options.height), options.backgroundTop,
                                     options.backgroundBottom);
  for (std::size_t i = 0; i < backdrop.rgba.size(); i += 4) {  // the soft shoulder of shaders/resolve.frag
    float* c = &backdrop.rgba[i];
    const float shoulder = 1 + 0.25f * std::max({c[0], c[1], c[2]});
    for (int k = 0; k < 3; ++k) c[k] /= shoulder;
  }
  const Image expected = toSrgb(backdrop);
  int worst = 0;
  for (std::size_t i = 0; i < drawn.rgba.size(); ++i) {
    worst = std::max(worst, std::abs(int(drawn.rgba[i]) - int(expected.rgba[i])));
  }
  EXPECT_LE(worst, 1);  // the preview dithers by half a step, and both round
}

TEST_F(Rendering, RefusesWhatItCannotDraw) {
  PreviewScene scene;
  PreviewOptions options = small();
  options.width = 0;
  EXPECT_EQ(preview()->render(scene, options).error().code, ErrorCode::InvalidArgument);
  options = small();
  options.subframes = 65;
  EXPECT_EQ(preview()->render(scene, options).error().code, ErrorCode::InvalidArgument);
  options = small();
  scene.camera.up = scene.camera.target - scene.camera.eye;
  EXPECT_EQ(preview()->render(scene, options).error().code, ErrorCode::InvalidArgument);
  scene.camera = Camera{};
  scene.camera.eye.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(preview()->render(scene, options).error().code, ErrorCode::InvalidArgument);
  scene.camera = Camera{};
  PolygonMesh head = makeExampleHead(16);
  head.corners[7] = 1u << 30;
  scene.head = &head;
  EXPECT_FALSE(preview()->render(scene, options).ok());
  scene.head = nullptr;
  const std::atomic<bool> stop = true;
  Context context;
  context.cancel = &stop;
  EXPECT_EQ(preview()->render(scene, options, context).error().code, ErrorCode::Cancelled);
}

TEST_F(Rendering, TheHairMeshIsDrawnOver) {
  const std::vector<Vec3> corners{{-0.4, -0.4, 0}, {0.4, -0.4, 0}, {0.4, 0.4, 0}, {-0.4, 0.4, 0}};
  const std::vector<std::uint32_t> offsets{0, 4}, face{0, 1, 2, 3};
  const auto mesh = HairMesh::fromRoot(corners, offsets, face);
  ASSERT_TRUE(mesh.ok());
  PreviewScene scene;
  scene.hairMesh = &*mesh;
  scene.camera = straightCamera(128);
  const Image image = render(scene, small(128, 16)).image;
  // Four edges of 80 px, 1.6 wide, 0.9 opaque, over a face of 80 x 80 of which a tenth shows.
  const double edges = 4 * 80 * 1.6;
  EXPECT_NEAR(alphaSum(image), 0.9 * edges + 0.1 * (80 * 80 - edges),
              0.06 * 80 * 80 * 0.2);  // corners overlap
}

}  // namespace
}  // namespace coif
