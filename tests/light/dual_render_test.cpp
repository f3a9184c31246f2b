#include "coif/light/dual_render.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace coif
