#include "coif/light/path_tracer.h"

#include <gtest/gtest.h>

#include <atomic>
#include <memory>

#include "path_scenes.h"

namespace coif::testing {
namespace {

class PathTracerTest : public ::testing::Test {
 protected:
  void SetUp() override {
    PathTraceOptions tiny;
    tiny.width = tiny.height = 1;
    const auto probe = coif::pathTrace({}, tiny);
    if (!probe.ok() && probe.error().code == ErrorCode::Unsupported) GTEST_SKIP() << probe.error().text();
  }
  static PathTracePicture trace(const PathTraceScene& scene, const PathTraceOptions& options,
                                const Context& context = {}) {
    auto picture = coif::pathTrace(scene, options, context);
    EXPECT_TRUE(picture.ok()) << picture.error().text();
    return picture.ok() ? *std::move(picture) : PathTracePicture{};
  }
  static PathTraceOptions small(int size, int samples) {
    PathTraceOptions options;
    options.width = options.height = size;
    options.samplesPerPixel = samples;
    return options;
  }
  static FibreParameters fibreOf(double absorption) {
    FibreParameters fibre;
    fibre.absorption = Vec3::Constant(absorption);
    return fibre;
  }
  // Three standard errors of a difference, and float's rounding.
  static double tolerance(const PathTracePicture& a, const PathTracePicture& b) {
    return 3 / 1.96 * (a.confidence95 + b.confidence95).maxCoeff() + 1e-6 * a.mean.maxCoeff();
  }
  static double meanAlpha(const FloatImage& image) {
    double sum = 0;
    for (std::size_t i = 3; i < image.rgba.size(); i += 4) sum += double(image.rgba[i]);
    return sum / (double(image.width) * image.height);
  }
};

TEST_F(PathTracerTest, ALosslessClusterVanishesInAConstantEnvironment) {
  const StrandSet strands = cluster(600, 0.03f);
  PathTraceScene scene;
  scene.strands = &strands;
  scene.camera = farCamera(1);
  scene.lights = uniformLight();
  for (const double roughness : {0.15, 0.6}) {
    scene.fibre = fibreOf(0);
    scene.fibre.longitudinalRoughness = scene.fibre.azimuthalRoughness = roughness;
    PathTraceOptions options = small(24, 32);
    options.showSurroundings = true;
    const PathTracePicture picture = trace(scene, options);
    EXPECT_GT(meanAlpha(picture.image), 0.5);
    EXPECT_GT(double(picture.rays), 4.0 * double(picture.paths));  // it is a thicket
    EXPECT_EQ(picture.truncatedPaths, 0u);
    for (int c = 0; c < 3; ++c) {
      // 1e-4: what the fibre function's own integrals are good to, a few bounces long.
      EXPECT_NEAR(picture.mean[c], 1, 3 / 1.96 * picture.confidence95[c] + 1e-4) << roughness;
    }
    EXPECT_LT(picture.confidence95.maxCoeff(), 0.01);
  }
}

// The same by sampling the light: evaluate(), pdf() and the weights between the two ways, none of which a
// path that only escapes needs.
TEST_F(PathTracerTest, ALosslessClusterVanishesInAPictureOfEvenLight) {
  const StrandSet strands = cluster(300, 0.03f);
  PathTraceScene scene;
  scene.strands = &strands;
  scene.camera = farCamera(0.6);
  scene.lights = darkness();
  const auto white = std::make_shared<FloatImage>(2, 1);
  std::fill(white->rgba.begin(), white->rgba.end(), 1.0f);
  scene.lights.surroundings = white;
  scene.fibre = fibreOf(0);
  PathTraceOptions options = small(16, 64);
  options.showSurroundings = true;
  const PathTracePicture picture = trace(scene, options);
  EXPECT_GT(picture.shadowRays, picture.paths);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(picture.mean[c], 1, 3 / 1.96 * picture.confidence95[c]);
  EXPECT_GT(picture.confidence95[0], 0);
  EXPECT_LT(picture.confidence95[0], 0.02);
}

// One vertical fibre, wider than the view.
StrandSet wideFibre() {
  StrandSet strands;
  addStrand(strands, {Vec3f(0, -30, 0), Vec3f(0, 30, 0)}, 2);
  return strands;
}

TEST_F(PathTracerTest, OneFibreUnderADistantLightIsTheFarField) {
  StrandSet strands;
  addStrand(strands, {Vec3f(0, -0.6f, 0), Vec3f(0, 0.6f, 0)}, 0.04f);
  PathTraceScene scene;
  scene.strands = &strands;
  scene.fibre = fibreOf(0.1);
  scene.lights = darkness();
  scene.lights.key = {Vec3(0.5, 0.7, 0.6), Vec3f(2, 3, 4)};
  PathTraceOptions options = small(32, 128);
  options.height = 4;
  scene.camera.eye.z() = 20;  // perspective turns ω_o by 0.06° at most
  scene.camera.fovDeg = 2 * std::atan(0.5 * 0.044 * 4 / 32 / 20) * 180 / 3.14159265358979323846;
  const PathTracePicture picture = trace(scene, options);
  // In the fibre's frame x is y here, and azimuths count from any direction across it.
  const auto local = [](const Vec3& v) { return Vec3(v.y(), v.z(), v.x()); };
  const FibreScattering fibre(scene.fibre);
  const Vec3 wi = local(scene.lights.key.direction.normalized()), wo = local(Vec3::UnitZ());
  const Vec3 expected = fibre.evaluate(wi, wo).cwiseProduct(Vec3(2, 3, 4));
  const double alpha = meanAlpha(picture.image);
  EXPECT_NEAR(alpha, 2 / 2.2, 0.01);  // the share of the view's width, with 16 000 samples
  for (int c = 0; c < 3; ++c) {
    // 1 %: 96 strips of the far field, and the float ray's 1e-4 of the radius.
    EXPECT_NEAR(picture.mean[c] / alpha, expected[c],
                3 / 1.96 * picture.confidence95[c] / alpha + 0.01 * expected[c]);
  }
}

TEST_F(PathTracerTest, OneFibreInAUniformEnvironmentShowsItsAlbedo) {
  const StrandSet strands = wideFibre();
  PathTraceScene scene;
  scene.strands = &strands;
  scene.camera = farCamera(0.2);  // the middle: h within ± 0.1
  scene.fibre = fibreOf(0.3);
  scene.lights = uniformLight(2);
  const PathTracePicture picture = trace(scene, small(8, 512));
  // ∫ f cos θ_i dω_i by the midpoint rule in sin θ and φ.
  const FibreScattering fibre(scene.fibre);
  double albedo = 0;
  constexpr int kTheta = 200, kPhi = 400;
  for (int t = 0; t < kTheta; ++t) {
    const double x = -1 + (2 * t + 1.0) / kTheta, r = std::sqrt(1 - x * x);
    for (int p = 0; p < kPhi; ++p) {
      const double phi = 2 * 3.14159265358979323846 * (p + 0.5) / kPhi;
      for (const double h : {-0.07, 0.0, 0.07}) {
        albedo += fibre.evaluate(Vec3(x, r * std::cos(phi), r * std::sin(phi)), Vec3::UnitY(), h)[0] / 3;
      }
    }
  }
  albedo *= 4 * 3.14159265358979323846 / (kTheta * kPhi);
  EXPECT_LT(albedo, 0.8);
  EXPECT_NEAR(picture.mean[0], 2 * albedo,
              3 / 1.96 * picture.confidence95[0] + 0.005 * albedo);  // three h's for all
}

TEST_F(PathTracerTest, AGlossyFibreShinesOnTheLightsSide) {
  const StrandSet strands = wideFibre();
  PathTraceScene scene;
  scene.strands = &strands;
  scene.camera = farCamera(2);
  scene.fibre = fibreOf(50);  // only R is left
  scene.fibre.azimuthalRoughness = 0.1;
  scene.lights = darkness();
  scene.lights.key = {Vec3(1, 0, 0.3), Vec3f::Ones()};
  const PathTracePicture picture = trace(scene, small(32, 16));
  double left = 0, right = 0;
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) (x < 16 ? left : right) += double(picture.image.at(x, y)[0]);
  }
  EXPECT_GT(right, 3 * left);
}

TEST_F(PathTracerTest, MoreAbsorptionLeavesLessLight) {
  const StrandSet strands = cluster(400, 0.03f);
  PathTraceScene scene;
  scene.strands = &strands;
  scene.camera = farCamera(1);
  scene.lights = uniformLight();
  PathTracePicture former;
  for (const double absorption : {0.0, 0.05, 0.2, 1.0, 1e4}) {
    scene.fibre = fibreOf(absorption);
    const PathTracePicture picture = trace(scene, small(16, 32));
    if (absorption > 0) {
      EXPECT_LT(picture.mean[0] + picture.confidence95[0], former.mean[0]) << absorption;
    }
    former = picture;
  }
  EXPECT_GT(former.mean[0], 0);  // the surface still reflects
}

TEST_F(PathTracerTest, RussianRouletteChangesNoMean) {
  const StrandSet strands = cluster(300, 0.03f);
  PathTraceScene scene;
  scene.strands = &strands;
  scene.camera = farCamera(1);
  scene.fibre = fibreOf(0.3);
  scene.lights = uniformLight();
  PathTraceOptions options = small(16, 256);
  options.rouletteStart = 0;
  const PathTracePicture early = trace(scene, options);
  options.rouletteStart = 100000;
  options.seed = 1;
  const PathTracePicture never = trace(scene, options);
  EXPECT_LT(early.rays, never.rays);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(early.mean[c], never.mean[c], tolerance(early, never));
  EXPECT_LT(early.confidence95[0] + never.confidence95[0], 0.05 * never.mean[0]);
}

TEST_F(PathTracerTest, AHeadReflectsWhatLambertSays) {
  const PolygonMesh head = square(Vec3::UnitZ(), 10);
  PathTraceScene scene;
  scene.head = &head;
  scene.headColor = Vec3f(0.5f, 0.25f, 1);
  scene.camera = farCamera(1);
  scene.lights = darkness();
  scene.lights.rim = {Vec3(0, 3, 4), Vec3f(1, 2, 3)};
  const PathTracePicture picture = trace(scene, small(4, 4));
  const Vec3 expected = Vec3(0.5, 0.5, 3) * 0.8 / 3.14159265358979323846;
  for (std::size_t p = 0; p < 16; ++p) {
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(picture.image.rgba[4 * p + std::size_t(c)], expected[c], 1e-6);  // float
  }
  scene.lights.rim.direction.z() = -4;  // from behind
  EXPECT_EQ(trace(scene, small(4, 4)).mean.maxCoeff(), 0);
}

TEST_F(PathTracerTest, SkyAndGroundLightAFaceByItsSlope) {
  for (const double slopeDeg : {0.0, 40.0, 130.0}) {
    const double slope = slopeDeg * 3.14159265358979323846 / 180;
    const Vec3 normal(0, std::cos(slope), std::sin(slope));
    const PolygonMesh head = square(normal, 10);
    PathTraceScene scene;
    scene.head = &head;
    scene.headColor = Vec3f::Constant(0.5f);
    scene.camera.eye = normal + Vec3(0, 0, 0.2);
    scene.camera.up = Vec3::UnitX();
    scene.camera.fovDeg = 10;
    scene.lights = darkness();
    scene.lights.skyColor = Vec3f::Constant(3);
    scene.lights.groundColor = Vec3f::Constant(1);
    const PathTracePicture picture = trace(scene, small(8, 256));
    // A face sees the share (1 + n · up) / 2 of its cosine-weighted half space in the upper half.
    const double expected = 0.5 * (1 + 2 * 0.5 * (1 + std::cos(slope)));
    EXPECT_NEAR(picture.mean[0], expected, 3 / 1.96 * picture.confidence95[0] + 1e-6) << slopeDeg;
  }
}

TEST_F(PathTracerTest, APointLightFadesWithTheSquareOfItsDistance) {
  PathTraceScene scene;
  scene.ground = Ground{Vec3::Zero(), Vec3(0, 0, 5), 100, Vec3f::Constant(0.5f)};
  scene.camera = farCamera(0.01);
  for (const double distance : {1.0, 2.0, 8.0}) {
    scene.lights = darkness();
    scene.lights.points = {{Vec3(0, 0, distance), Vec3f::Constant(3)}};
    const PathTracePicture picture = trace(scene, small(2, 4));
    const double expected = 0.5 * 3 / (3.14159265358979323846 * distance * distance);
    EXPECT_NEAR(picture.mean[0], expected, 3e-4 * expected);  // paths start 1e-4 above the face
  }
}

TEST_F(PathTracerTest, HairShadowsTheGroundAndItsEdgesAreTheGrounds) {
  StrandSet strands;
  addStrand(strands, {Vec3f(0, -5, 1), Vec3f(0, 5, 1)}, 0.5f);
  PathTraceScene scene;
  scene.strands = &strands;
  scene.fibre = fibreOf(1e4);
  scene.ground = Ground{Vec3::Zero(), Vec3::UnitZ(), 2, Vec3f::Constant(0.5f)};
  scene.camera = farCamera(8);
  scene.lights = darkness();
  scene.lights.key = {Vec3(1, 0, 1), Vec3f::Ones()};  // the shadow falls to x = −1
  const PathTracePicture picture = trace(scene, small(80, 4));
  const auto at = [&](double x, double y) { return picture.image.at(int(40 + 10 * x), int(40 - 10 * y)); };
  const double lit = 0.5 * std::sqrt(0.5) / 3.14159265358979323846;
  EXPECT_NEAR(at(1.05, 0.05)[0], lit, 0.01 * lit);  // and a little from the fibre
  EXPECT_LT(at(-1.05, 0.05)[0], 0.05 * lit);        // only what the fibre reflects
  EXPECT_EQ(at(1.85, 0.05)[3], 1);
  EXPECT_EQ(at(2.25, 0.05)[3], 0);
}

TEST_F(PathTracerTest, TheConfidenceIntervalCovers) {
  const StrandSet strands = cluster(150, 0.03f);
  PathTraceScene scene;
  scene.strands = &strands;
  scene.camera = farCamera(1);
  scene.fibre = fibreOf(0.2);
  scene.lights = darkness();
  scene.lights.key = {Vec3(0.3, 0.5, 1), Vec3f::Constant(3)};
  const PathTracePicture truth = trace(scene, small(8, 4096));
  constexpr int kRuns = 60;
  int covered = 0;
  double spread = 0, claimed = 0;
  for (int run = 0; run < kRuns; ++run) {
    PathTraceOptions options = small(8, 32);
    options.seed = 100 + std::uint64_t(run);
    const PathTracePicture picture = trace(scene, options);
    const double error = picture.mean[1] - truth.mean[1];
    covered += std::abs(error) <= picture.confidence95[1] ? 1 : 0;
    spread += error * error;
    claimed += std::pow(picture.confidence95[1] / 1.96, 2);
  }
  // 57 of 60 are expected, with a standard deviation of 1.7; four of those, and not all too wide.
  EXPECT_GE(covered, 50);
  // A variance from 60 runs is good to √(2/60) = 18 %; three of those.
  EXPECT_NEAR(claimed / spread, 1, 0.55);
}

TEST_F(PathTracerTest, EverySampleIsCountedOnceWhateverTheThreadsAndRounds) {
  const StrandSet strands = cluster(100, 0.03f);
  PathTraceScene scene;
  scene.strands = &strands;
  scene.camera = farCamera(1);
  Context one, two;
  one.threads = 1, two.threads = 2;
  const PathTraceOptions options = small(20, 64);
  const PathTracePicture a = trace(scene, options, one), b = trace(scene, options, two);
  EXPECT_EQ(a.image.rgba, b.image.rgba);
  EXPECT_EQ(a.standardError.rgba, b.standardError.rgba);
  EXPECT_EQ(a.rays, b.rays);
  PathTraceOptions target = options;
  target.targetError = 1e-9;  // never reached: rounds of 16, 16, 32
  const PathTracePicture rounds = trace(scene, target, two);
  EXPECT_EQ(rounds.image.rgba, a.image.rgba);
  target.targetError = 1.5 * a.relativeError;
  const PathTracePicture enough = trace(scene, target, two);
  EXPECT_LT(enough.samplesPerPixel, 64);
  EXPECT_LE(enough.relativeError, target.targetError);
}

TEST_F(PathTracerTest, BrokenStrandsAreLeftOutAndCounted) {
  StrandSet strands = cluster(50, 0.03f);
  PathTraceScene scene;
  scene.strands = &strands;
  scene.camera = farCamera(1);
  const PathTracePicture whole = trace(scene, small(12, 8));
  addStrand(strands, {Vec3f(0, 0, 0), Vec3f(0, NAN, 0)}, 0.5f);
  addStrand(strands, {Vec3f(0, 0, 0)}, 0.5f);
  const PathTracePicture picture = trace(scene, small(12, 8));
  EXPECT_EQ(picture.strandsDropped, 2u);
  ASSERT_EQ(picture.notes.size(), 1u);
  EXPECT_EQ(picture.image.rgba, whole.image.rgba);
}

TEST_F(PathTracerTest, NothingAndWidthlessHairAreAnEmptyPicture) {
  StrandSet strands = cluster(50, 0.0f);
  PathTraceScene scene;
  scene.camera = farCamera(1);
  EXPECT_EQ(trace(scene, small(4, 2)).image.rgba, std::vector<float>(64, 0.0f));
  scene.strands = &strands;
  EXPECT_EQ(trace(scene, small(4, 2)).image.rgba, std::vector<float>(64, 0.0f));
  const StrandSet none;
  scene.strands = &none;
  EXPECT_EQ(trace(scene, small(4, 2)).image.rgba, std::vector<float>(64, 0.0f));
}

TEST_F(PathTracerTest, ExtremesGiveNumbers) {
  const StrandSet strands = cluster(200, 0.05f);
  PathTraceScene scene;
  scene.strands = &strands;
  scene.camera.eye = Vec3(0.01, 0, 0);  // inside the hair
  scene.camera.target = Vec3(0, 0, 1);
  scene.lights.points = {{Vec3(0, 0.01, 0.02), Vec3f::Ones()}};  // and a light
  for (const FibreModel model : {FibreModel::Chiang, FibreModel::Marschner, FibreModel::KajiyaKay}) {
    for (const double roughness : {1e-3, 1.0}) {
      for (const double absorption : {0.0, 0.1, 1e4}) {
        scene.fibre = fibreOf(absorption);
        scene.fibre.model = model;
        scene.fibre.longitudinalRoughness = scene.fibre.azimuthalRoughness = roughness;
        const PathTracePicture picture = trace(scene, small(8, 8));
        for (const float v : picture.image.rgba) ASSERT_TRUE(std::isfinite(v) && v >= 0);
        EXPECT_EQ(picture.invalidPaths, 0u);
      }
    }
  }
}

TEST_F(PathTracerTest, LightAlongTheHairGivesNumbers) {
  StrandSet one;
  addStrand(one, {Vec3f(-1, 0, 0), Vec3f(1, 0, 0)}, 0.2f);
  PathTraceScene scene;
  scene.strands = &one;
  scene.camera = farCamera(1);
  scene.lights.followCamera = false;
  scene.lights.key.direction = Vec3(std::sin(1.5690509975429023), std::cos(1.5690509975429023), 0);  // 89.9°
  for (const FibreModel model : {FibreModel::Chiang, FibreModel::Marschner, FibreModel::KajiyaKay}) {
    scene.fibre = fibreOf(0.1);
    scene.fibre.model = model;
    const PathTracePicture picture = trace(scene, small(8, 8));
    for (const float v : picture.image.rgba) ASSERT_TRUE(std::isfinite(v) && v >= 0);
    EXPECT_EQ(picture.invalidPaths, 0u);
  }
}

TEST_F(PathTracerTest, StrandColoursAreSeen) {
  StrandSet strands = cluster(300, 0.04f);
  strands.colors.assign(strands.points.size(), Vec3f(0.6f, 0.1f, 0.02f));
  PathTraceScene scene;
  scene.strands = &strands;
  scene.camera = farCamera(0.8);
  scene.lights = uniformLight();
  scene.useStrandColors = true;
  const PathTracePicture red = trace(scene, small(8, 32));
  EXPECT_GT(red.mean[0], 1.5 * red.mean[1]);
  EXPECT_GT(red.mean[1], red.mean[2]);
  // All one colour: the same as giving its absorption, but for the palette's steps.
  scene.useStrandColors = false;
  scene.fibre.absorption = Vec3(5, 5, 5);
  EXPECT_LT(trace(scene, small(8, 32)).mean[0], red.mean[0]);
}

TEST_F(PathTracerTest, RefusesNonsenseAndStopsWhenAsked) {
  PathTraceScene scene;
  const auto code = [&](const PathTraceScene& s, const PathTraceOptions& o) {
    const auto picture = coif::pathTrace(s, o);
    return picture.ok() ? ErrorCode::Unsupported : picture.error().code;
  };
  EXPECT_EQ(code(scene, small(0, 4)), ErrorCode::InvalidArgument);
  EXPECT_EQ(code(scene, small(4, 1)), ErrorCode::InvalidArgument);
  scene.camera.up = Vec3::UnitZ();
  EXPECT_EQ(code(scene, small(4, 4)), ErrorCode::InvalidArgument);
  scene = {};
  scene.lights.key.color = Vec3f(1, -1, 1);
  EXPECT_EQ(code(scene, small(4, 4)), ErrorCode::InvalidArgument);
  scene = {};
  scene.headColor = Vec3f(NAN, 0, 0);
  EXPECT_EQ(code(scene, small(4, 4)), ErrorCode::InvalidArgument);
  scene = {};
  scene.ground = Ground{Vec3::Zero(), Vec3::Zero()};
  EXPECT_EQ(code(scene, small(4, 4)), ErrorCode::InvalidArgument);
  std::atomic<bool> stop{true};
  Context context;
  context.cancel = &stop;
  const auto cancelled = coif::pathTrace(PathTraceScene{}, small(4, 4), context);
  ASSERT_FALSE(cancelled.ok());
  EXPECT_EQ(cancelled.error().code, ErrorCode::Cancelled);
  double last = 0;
  context = {};
  context.progress = [&](std::string_view, double fraction) {
    EXPECT_GT(fraction, last);
    last = fraction;
  };
  ASSERT_TRUE(coif::pathTrace(PathTraceScene{}, small(200, 4), context).ok());
  EXPECT_NEAR(last, 1, 1e-12);
}

}  // namespace
}  // namespace coif::testing
