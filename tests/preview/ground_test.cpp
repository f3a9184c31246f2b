// The disc under the head: its area, its light, and the shadow on it.
#include <cmath>
#include <numbers>

#include "coif/light/dual_scattering.h"
#include "preview/preview_fixture.h"

namespace coif {
namespace {

class Grounds : public testing::PreviewTest {
 protected:
  static constexpr float kLight = 0.2f;  // dim: the picture's shoulder takes the brightest down
  // From above, over a disc of radius 1 in the middle of 128 × 128 pixels that show 4 × 4 units.
  static PreviewScene scene() {
    PreviewScene scene;
    scene.camera.eye = Vec3(0, 10, 0);
    scene.camera.up = Vec3::UnitZ();
    scene.camera.fovDeg = 2 * std::atan(0.2) * 180 / std::numbers::pi;
    scene.ground = Ground{Vec3::Zero(), Vec3(0, 3, 0), 1, Vec3f::Constant(0.4f)};
    scene.lights.followCamera = false;
    scene.lights.fill.color = scene.lights.rim.color = Vec3f::Zero();
    scene.lights.skyColor = scene.lights.groundColor = Vec3f::Zero();
    scene.lights.key = {Vec3(1, 1, 0), Vec3f::Constant(kLight)};
    return scene;
  }
  // Lambert: albedo · light · cos 45° / π.
  static constexpr double kLit = 0.4 * kLight * 0.5 * std::numbers::sqrt2 / std::numbers::pi;
  static double linearAt(const Image& image, int x, int y) {
    const double v = image.rgba[4 * (std::size_t(y) * std::size_t(image.width) + std::size_t(x))] / 255.0;
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  }
  static PolygonMesh plate(double height) {
    PolygonMesh mesh;
    mesh.positions = {{-0.2, height, -0.2}, {0.2, height, -0.2}, {0.2, height, 0.2}, {-0.2, height, 0.2}};
    mesh.faceOffsets = {0, 4};
    mesh.corners = {0, 3, 2, 1};
    return mesh;
  }
};

TEST_F(Grounds, CoverTheirAreaAndReflectAsLambertSays) {
  const Picture picture = render(scene(), small(128, 4));
  const double unit = 32;  // pixels
  EXPECT_NEAR(alphaSum(picture.image), std::numbers::pi * unit * unit, 0.01 * std::numbers::pi * unit * unit)
      << "16 samples a pixel along the rim";
  double mean = 0;  // of many pixels: each is dithered by half a step
  for (int y = 54; y < 74; ++y) {
    for (int x = 54; x < 74; ++x) mean += linearAt(picture.image, x, y) / 400;
  }
  EXPECT_NEAR(mean, kLit, 0.01 * kLit);
  PreviewScene none = scene();
  none.ground.reset();
  EXPECT_EQ(alphaSum(render(none, small()).image), 0);
}

TEST_F(Grounds, LieInTheHeadsShadowWhereTheLightSaysSo) {
  PreviewScene shaded = scene();
  const PolygonMesh head = plate(0.5);
  shaded.head = &head;
  const Image image = render(shaded, small(256, 4)).image;
  const auto at = [&](double x, double z) {
    // Seen from above with +z up, x runs to the left.
    return linearAt(image, int(std::lround(128 - 64 * x)), int(std::lround(128 - 64 * z)));
  };

  EXPECT_NEAR(at(-0.5, 0), 0, 1e-3) << "the plate's shadow falls as far aside as it is high";
  EXPECT_NEAR(at(-0.5, 0.5), kLit, 0.1 * kLit);
  EXPECT_NEAR(at(0.6, 0), kLit, 0.1 * kLit);
}

// A sheet of hair between light and ground: T_f = T^(1 − ā_f), with light's own ā_f, so that the logarithms of two
// colours' shadows are to each other as what the hairs stop.
TEST_F(Grounds, GetTheLightThatGoesOnThroughHair) {
  constexpr int kHairs = 3000;
  StrandSet hair;
  for (int i = 0; i < kHairs; ++i) {
    const double x = -0.6 + 1.2 * std::fmod((i + 0.5) * 0.61803398875, 1.0), y = 0.5 + 0.05 * i / kHairs;
    for (const double z : {-0.6, 0.6}) {
      hair.points.emplace_back(float(x), float(y), float(z));
      hair.widths.push_back(float(1.2 * std::sqrt(0.5) / kHairs));  // optical depth 1, as the light sees it
    }
    hair.offsets.push_back(hair.points.size());
  }
  PreviewScene under = scene();
  under.lights.key.color = Vec3f::Constant(5);
  under.strands = &hair;
  const auto stopped = [&](double absorption, PreviewShading shading) {
    PreviewOptions options = small(128, 1);
    options.shading = shading;
    options.useAbsorption = true;
    options.fibre.absorption = Vec3::Constant(absorption);
    const Image image = render(under, options).image;
    double mean = 0;  // around where the sheet's shadow is deepest, beside the sheet itself
    for (int y = 58; y < 70; ++y) {
      for (int x = 88; x < 94; ++x) mean += linearAt(image, x, y) / 72;
    }
    return -std::log(mean / (25 * kLit));
  };
  const auto passes = [](double absorption) {
    FibreParameters fibre;
    fibre.absorption = Vec3::Constant(absorption);
    return DualScattering(FibreScattering(fibre)).means(0, 0).attenuationForward;
  };
  const double single = stopped(0.1, PreviewShading::Marschner);
  EXPECT_NEAR(single, 1, 0.15) << "unscattered light alone; the map's hairs are few and wide";
  for (const double absorption : {0.0, 0.1, 1.0}) {
    EXPECT_NEAR(stopped(absorption, PreviewShading::DualScattering) / single, 1 - passes(absorption), 0.02)
        << absorption;
  }
}

TEST_F(Grounds, RefuseWhatIsNone) {
  for (const auto spoil :
       {+[](Ground& g) { g.normal = Vec3::Zero(); }, +[](Ground& g) { g.radius = -1; },
        +[](Ground& g) { g.color = Vec3f::Constant(2); }, +[](Ground& g) { g.point.x() = NAN; }}) {
    PreviewScene bad = scene();
    spoil(*bad.ground);
    const auto picture = preview()->render(bad, small());
    ASSERT_FALSE(picture.ok());
    EXPECT_EQ(picture.error().code, ErrorCode::InvalidArgument);
  }
  PreviewScene endless = scene();
  endless.ground->radius = 1e30;
  EXPECT_EQ(alphaSum(render(endless, small()).image), 128 * 128) << "to the picture's rim and no overflow";
}

}  // namespace
}  // namespace coif
