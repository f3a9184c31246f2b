#include "coif/light/dual_render.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "coif/light/path_tracer.h"
#include "light_fixture.h"

namespace coif {
namespace {

// A loose sheet of black fibres across the view: nothing is scattered twice.
struct Sheet {
  StrandSet strands;
  Camera camera;
  Lights lights;
  FibreParameters fibre;
  Sheet() {
    for (int i = 0; i < 24; ++i) {
      const float y = 0.04f * (float(i) - 11.5f);
      addStrand(strands, {Vec3f(-0.6f, y, 0), Vec3f(0, y, 0.05f), Vec3f(0.6f, y, 0)}, 0.02f);
    }
    camera.eye = Vec3(0, 0.1, 4);
    camera.fovDeg = 16;
    lights.followCamera = false;
    lights.key = {Vec3(0.3, 1, 1), Vec3f::Constant(3)};
    lights.fill.color = lights.rim.color = lights.skyColor = lights.groundColor = Vec3f::Zero();
    fibre.absorption = Vec3::Constant(50);
  }
};

DualRenderOptions smallPicture() {
  DualRenderOptions options;
  options.width = options.height = 24;
  options.samplesPerPixel = 64;
  return options;
}

Vec3 meanOf(const FloatImage& image) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < image.rgba.size(); ++i) {
    if (i % 4 < 3) sum[long(i % 4)] += double(image.rgba[i]);
  }
  return sum / (image.width * image.height);
}

TEST(DualRender, SingleScatteringIsThePathTracers) {
  const Sheet sheet;
  const auto shooter = StrandShooter::create(sheet.strands);
  if (!shooter.ok()) GTEST_SKIP() << shooter.error().text();
  PathTraceScene truth;
  truth.strands = &sheet.strands;
  truth.camera = sheet.camera;
  truth.lights = sheet.lights;
  truth.fibre = sheet.fibre;
  PathTraceOptions tracing;
  tracing.width = tracing.height = 24;
  tracing.samplesPerPixel = 64;
  tracing.maxBounces = 1;
  const auto traced = pathTrace(truth, tracing);
  ASSERT_TRUE(traced.ok()) << traced.error().text();
  const DualScattering hair(FibreScattering(sheet.fibre), {DualFormulas::Corrected, 0, 0});
  const auto picture = renderDualScattering({&*shooter, &hair, sheet.camera, sheet.lights}, smallPicture());
  ASSERT_TRUE(picture.ok());
  const Vec3 mine = meanOf(*picture);
  EXPECT_GT(traced->mean.x(), 1e-3);
  // Both are means of as many samples: twice the interval of 95 %.
  EXPECT_LT((mine - traced->mean).cwiseAbs().maxCoeff(), 2 * traced->confidence95.maxCoeff());
}

// Parallel fibres along x, a square of them: what one knows of the hair around it.
struct Square {
  static constexpr int kSide = 41;
  StrandSet strands;
  FibreParameters fibre;
  Square() {
    for (int i = 0; i < kSide * kSide; ++i) {
      const float y = float(i % kSide) - kSide / 2, z = float(i / kSide) - kSide / 2;
      addStrand(strands, {Vec3f(-200, y, z), Vec3f(200, y, z)}, 0.5f);
    }
    fibre.absorption = Vec3(0.1, 0.2, 0.4);
  }
  static std::uint32_t at(int y, int z) { return std::uint32_t((z + kSide / 2) * kSide + y + kSide / 2); }
};

SurroundingLight around(const StrandShooter& strands, const DualScattering& hair, int y, int z,
                        const Vec3& toLight) {
  std::vector<StrandMeeting> meetings;
  SurroundingLight out;
  shootAround(strands, hair, Vec3(0, y, z), Square::at(y, z), Mat3::Identity(), toLight, 64,
              CounterRandom(3, 0), meetings, out);
  return out;
}

double arriving(const SurroundingLight& light) {
  double sum = 0;
  for (const auto& one : light.arrivals) sum += one.transmittance.x() / double(light.arrivals.size());
  return sum;
}

TEST(DualRender, SurroundingsOfALoneFibreAreNothing) {
  StrandSet one;
  addStrand(one, {Vec3f(-1, 0, 0), Vec3f(1, 0, 0)}, 0.1f);
  const auto shooter = StrandShooter::create(one);
  if (!shooter.ok()) GTEST_SKIP() << shooter.error().text();
  std::vector<StrandMeeting> meetings;
  SurroundingLight light;
  const DualScattering hair{FibreScattering(Square().fibre)};
  shootAround(*shooter, hair, Vec3::Zero(), 0, Mat3::Identity(), Vec3::UnitZ(), 16, CounterRandom(3, 0),
              meetings, light);
  EXPECT_EQ(light.directFraction, 1);
  EXPECT_EQ(arriving(light), 0);
  EXPECT_EQ(light.backscatter, Vec3::Zero());
}

TEST(DualRender, SurroundingsKnowTheSurfaceAndTheInside) {
  const Square square;
  const auto shooter = StrandShooter::create(square.strands);
  if (!shooter.ok()) GTEST_SKIP() << shooter.error().text();
  const DualScattering hair{FibreScattering(square.fibre)};
  constexpr int edge = Square::kSide / 2;
  // In the middle of the lit side: nothing in front but the row's own neighbours, which a quarter of a cell
  // sticks out of, 14 degrees at each end of the half circle; hair behind nearly all around.
  const SurroundingLight top = around(*shooter, hair, 0, edge, Vec3::UnitZ());
  EXPECT_EQ(top.directFraction, 1);
  EXPECT_LT(arriving(top), 28.0 / 180);
  EXPECT_GT(top.backscatter.minCoeff(), 0.9);
  // In the far side: no hair behind.
  const SurroundingLight bottom = around(*shooter, hair, 0, -edge, Vec3::UnitZ());
  EXPECT_EQ(bottom.directFraction, 0);
  EXPECT_LT(bottom.backscatter.maxCoeff(), 28.0 / 180);
  // On a lit corner, light from the diagonal meets hair on half the way around at both ends of the cone at
  // most.
  const SurroundingLight side = around(*shooter, hair, 0, edge, Vec3(0, 1, 0.02).normalized());
  EXPECT_GT(side.backscatter.minCoeff(), 0.3);
  EXPECT_LT(side.backscatter.maxCoeff(), 0.7);  // light along the surface: half of what is behind is air
  // Inside, what arrives falls with every layer, and is less than the layers' straight path where it goes
  // around.
  const double second = arriving(around(*shooter, hair, 0, edge - 1, Vec3::UnitZ())),
               fourth = arriving(around(*shooter, hair, 0, edge - 3, Vec3::UnitZ()));
  EXPECT_GT(second, 0.1);
  EXPECT_GT(fourth, 0);
  EXPECT_LT(fourth, second);
}

TEST(DualRender, SameBytesForAnyNumberOfThreads) {
  const Sheet sheet;
  const auto shooter = StrandShooter::create(sheet.strands);
  if (!shooter.ok()) GTEST_SKIP() << shooter.error().text();
  const DualScattering hair{FibreScattering(sheet.fibre)};
  Context one, three;
  one.threads = 1;
  three.threads = 3;
  const DualRenderScene scene{&*shooter, &hair, sheet.camera, sheet.lights};
  EXPECT_EQ(renderDualScattering(scene, smallPicture(), one)->rgba,
            renderDualScattering(scene, smallPicture(), three)->rgba);
}

TEST(DualRender, MapsComeNearRays) {
  Sheet sheet;
  sheet.fibre.absorption = Vec3(0.02, 0.05, 0.1);
  const auto shooter = StrandShooter::create(sheet.strands);
  if (!shooter.ok()) GTEST_SKIP() << shooter.error().text();
  const DualScattering hair{FibreScattering(sheet.fibre)};
  const Box box{Vec3(-0.6, -0.5, 0), Vec3(0.6, 0.5, 0.05)};
  VisibilityOptions how;
  how.method = VisibilityMethod::Exact;
  const auto map = ForwardScatteringMap::build(sheet.strands, hair,
                                               distantLightView(sheet.lights.key.direction, box, 256), how);
  ASSERT_TRUE(map.ok());
  const ForwardScatteringMap* maps[] = {&*map};
  const DualRenderScene scene{&*shooter, &hair, sheet.camera, sheet.lights};
  DualRenderOptions options = smallPicture();
  options.surroundingRays = 0;  // maps know the straight path alone
  const Vec3 rays = meanOf(*renderDualScattering(scene, options));
  options.maps = maps;
  const Vec3 mapped = meanOf(*renderDualScattering(scene, options));
  // A fibre is some three texels wide, its surface a radius in front of the axis that the map knows.
  EXPECT_LT((mapped - rays).norm(), 0.1 * rays.norm());
}

TEST(DualRender, RefusesWhatItCannotDraw) {
  const Sheet sheet;
  const DualScattering hair{FibreScattering(sheet.fibre)};
  EXPECT_FALSE(renderDualScattering({nullptr, &hair, sheet.camera, sheet.lights}, {}).ok());
  const auto shooter = StrandShooter::create(sheet.strands);
  if (!shooter.ok()) GTEST_SKIP() << shooter.error().text();
  const ForwardScatteringMap* maps[] = {nullptr, nullptr};
  DualRenderOptions options = smallPicture();
  options.maps = maps;  // for one light
  EXPECT_FALSE(renderDualScattering({&*shooter, &hair, sheet.camera, sheet.lights}, options).ok());
}

TEST(DualRender, ExtremesGiveNumbers) {
  StrandSet one, broken = wavyStrands(40, 0.01f);
  addStrand(one, {Vec3f(0, 0.5f, 0.5f), Vec3f(1, 0.5f, 0.5f)}, 0.1f);
  broken.points[4].x() = NAN;
  StrandSet heap;  // on top of each other
  for (int i = 0; i < 60; ++i) addStrand(heap, {Vec3f(0.4f, 0.5f, 0.5f), Vec3f(0.6f, 0.5f, 0.5f)}, 0.02f);
  DualRenderOptions options = smallPicture();
  options.width = options.height = 8;
  options.samplesPerPixel = 4;
  for (const StrandSet& strands :
       {StrandSet{}, one, heap, wavyStrands(40, 0.0f), broken, wavyStrands(200, 0.02f)}) {
    const auto shooter = StrandShooter::create(strands);
    if (!shooter.ok()) GTEST_SKIP() << shooter.error().text();
    const bool isBroken = std::ranges::any_of(strands.points, [](const Vec3f& p) { return !p.allFinite(); });
    EXPECT_EQ(shooter->strandsDropped(), isBroken ? 1u : 0u);
    for (const double absorption : {0.0, 1e4}) {
      for (const double roughness : {1e-3, 1.0}) {
        FibreParameters fibre;
        fibre.absorption = Vec3(absorption, 0.1, absorption);
        fibre.longitudinalRoughness = fibre.azimuthalRoughness = roughness;
        const DualScattering hair{FibreScattering(fibre)};
        for (const Vec3& eye : {Vec3(0.5, 0.5, 4), Vec3(0.5, 0.5, 0.5)}) {  // before the hair, in it
          // From the side, and along the hair but for a tenth of a degree.
          for (const Vec3& toLight : {Vec3(0.3, 1, 1), Vec3(1, 0.0017, 0)}) {
            Camera camera;
            camera.eye = eye;
            camera.target = Vec3(0.5, 0.5, 0.4);
            Lights lights = Sheet().lights;
            lights.key.direction = toLight;
            const auto picture = renderDualScattering({&*shooter, &hair, camera, lights}, options);
            ASSERT_TRUE(picture.ok()) << picture.error().text();
            for (const float v : picture->rgba) ASSERT_TRUE(std::isfinite(v) && v >= 0);
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace coif
