#include <gtest/gtest.h>

#include "light/light_sampler.h"
#include "path_scenes.h"

namespace coif::testing {
namespace {

using light::SurroundingsSampler;

std::shared_ptr<FloatImage> noisySky(int width, int height) {
  auto image = std::make_shared<FloatImage>(width, height);
  for (std::size_t i = 0; i < image->rgba.size(); ++i) {
    image->rgba[i] = float(std::pow(CounterRandom(2, i).uniform(0), 6));
  }
  return image;
}

TEST(Surroundings, AreDrawnAsOftenAsTheirDensitySays) {
  const SurroundingsSampler sampler(noisySky(16, 8));
  // Mean of 1 / pdf over samples is the sphere's area (every texel has some light).
  constexpr int kSamples = 200000;
  double area = 0, squares = 0;
  std::array<double, 8> octants{}, expected{};
  for (int i = 0; i < kSamples; ++i) {
    const CounterRandom random(5, std::uint64_t(i));
    const Vec3 d = sampler.sample(random.uniform(0), random.uniform(1));
    ASSERT_NEAR(d.norm(), 1, 1e-9);
    const auto octant = std::size_t((d.x() > 0) + 2 * (d.y() > 0) + 4 * (d.z() > 0));
    octants[octant] += 1.0 / kSamples;
    // The same by uniform directions, weighted with the density.
    const double z = 2 * random.uniform(2) - 1, a = 6.283185307179586 * random.uniform(3);
    const Vec3 e(std::sqrt(1 - z * z) * std::cos(a), std::sqrt(1 - z * z) * std::sin(a), z);
    const double weight = sampler.pdf(e) * 4 * 3.14159265358979323846;
    expected[std::size_t((e.x() > 0) + 2 * (e.y() > 0) + 4 * (e.z() > 0))] += weight / kSamples;
    area += weight / kSamples;
    squares += weight * weight / kSamples;
  }
  const double sigma = std::sqrt(squares / kSamples);
  EXPECT_NEAR(area, 1, 4 * sigma);
  for (std::size_t o = 0; o < 8; ++o) EXPECT_NEAR(octants[o], expected[o], 4 * sigma) << o;
}

TEST(Surroundings, LieWhereTheHeaderSays) {
  // 8 columns, 4 rows: one bright texel; look where it is.
  const auto bright = [](int x, int y) {
    auto image = std::make_shared<FloatImage>(8, 4);
    image->at(x, y)[1] = 1;
    return SurroundingsSampler(image);
  };
  EXPECT_GT(bright(0, 0).sample(0.5, 0.5).y(), 0.8);
  EXPECT_LT(bright(0, 3).sample(0.5, 0.5).y(), -0.8);
  const Vec3 middle = bright(4, 1).sample(0.5, 0.5);  // right of the middle column
  EXPECT_GT(middle.z(), 0.7);
  EXPECT_LT(middle.x(), 0);  // looking along +z with y up, right is −x
  EXPECT_GT(bright(4, 1).radiance(middle).y(), 0.5);
}

class SurroundingsTraced : public ::testing::Test {
 protected:
  static PathTracePicture trace(const PathTraceScene& scene, int samples, int size = 8) {
    PathTraceOptions options;
    options.width = options.height = size;
    options.samplesPerPixel = samples;
    auto picture = coif::pathTrace(scene, options);
    if (!picture.ok() && picture.error().code == ErrorCode::Unsupported) return {};
    EXPECT_TRUE(picture.ok()) << picture.error().text();
    return *std::move(picture);
  }
};

TEST_F(SurroundingsTraced, AConstantPictureIsAConstantSky) {
  const StrandSet strands = cluster(300, 0.03f);
  PathTraceScene scene;
  scene.strands = &strands;
  scene.camera = farCamera(1);
  scene.fibre.absorption = Vec3::Constant(0.2);
  scene.lights = uniformLight(0.5f);
  const PathTracePicture sky = trace(scene, 256);
  auto image = std::make_shared<FloatImage>(4, 2);
  std::fill(image->rgba.begin(), image->rgba.end(), 0.5f);
  scene.lights.surroundings = image;
  const PathTracePicture picture = trace(scene, 256);
  if (picture.samplesPerPixel == 0) GTEST_SKIP() << "built without Embree";
  EXPECT_GT(picture.shadowRays, 0u);
  EXPECT_EQ(sky.shadowRays, 0u);
  EXPECT_NEAR(picture.mean[0], sky.mean[0], 3 / 1.96 * (picture.confidence95[0] + sky.confidence95[0]));
}

TEST_F(SurroundingsTraced, ASmallBrightTexelIsADistantLight) {
  const PolygonMesh head = square(Vec3::UnitZ(), 10);
  PathTraceScene scene;
  scene.head = &head;
  scene.headColor = Vec3f::Constant(0.5f);
  scene.camera = farCamera(1);
  scene.lights = darkness();
  auto image = std::make_shared<FloatImage>(64, 32);
  image->at(36, 12)[0] = image->at(36, 12)[1] = image->at(36, 12)[2] = 100;
  scene.lights.surroundings = image;
  const PathTracePicture picture = trace(scene, 64);
  if (picture.samplesPerPixel == 0) GTEST_SKIP() << "built without Embree";
  // ∫ over the texel of L n · ω / π · albedo, with n = +z the middle of the picture.
  const double pi = 3.14159265358979323846, t0 = pi * 12 / 32, t1 = pi * 13 / 32, a0 = 2 * pi * 4 / 64,
               a1 = 2 * pi * 5 / 64;
  const double across = std::sin(a1) - std::sin(a0),
               along = 0.5 * (t1 - t0) - 0.25 * (std::sin(2 * t1) - std::sin(2 * t0));
  EXPECT_NEAR(picture.mean[0], 0.5 / pi * 100 * across * along, 3 / 1.96 * picture.confidence95[0] + 1e-6);
  EXPECT_LT(picture.confidence95[0], 0.01 * picture.mean[0]);
}

}  // namespace
}  // namespace coif::testing
