#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "coif/base/random.h"
#include "preview/context_egl.h"
#include "preview/passes.h"
#include "preview/shader_files.h"
#include "preview_fixture.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wsign-compare"
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STB_IMAGE_IMPLEMENTATION
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace coif::preview {
namespace {

TEST(Shaders, EveryPermutationCompilesAndEveryFileIsUsed) {
  const auto context = EglContext::create();
  if (!context.ok()) GTEST_SKIP() << context.error().text();
  ASSERT_TRUE((*context)->makeCurrent().ok());
  std::string all;
  for (const ProgramSource& source : allPrograms()) {
    const auto program = buildProgram(source);
    EXPECT_TRUE(program.ok()) << (program.ok() ? "" : program.error().text());
    for (const std::string& name : {source.vertex, source.fragment}) {
      if (name.empty()) continue;  // a compute shader
      const auto text = shaderText(name, source.defines);
      ASSERT_TRUE(text.ok());
      EXPECT_EQ(text->find("#include"), std::string::npos);
      all += *text;
    }
  }
  for (const ShaderFile& file : embeddedShaders()) {
    const std::string_view line = file.text.substr(0, file.text.find('\n'));
    EXPECT_TRUE(line.starts_with("#include") || all.find(line) != std::string::npos) << file.name;
  }
  EXPECT_TRUE((*context)->log().errors.empty());
  (*context)->release();
}

TEST(Shaders, AFolderTakesTheirPlace) {
  const std::string original = *shaderText("strand.frag", {});
  setenv("COIF_SHADER_DIR", (std::string(COIF_SOURCE_DIR) + "/shaders").c_str(), 1);
  EXPECT_EQ(shaderText("strand.frag", {}).value(), original);
  const auto folder = std::filesystem::temp_directory_path() / ("coif_shaders_" + std::to_string(getpid()));
  std::filesystem::create_directory(folder);
  setenv("COIF_SHADER_DIR", folder.c_str(), 1);
  const auto missing = shaderText("strand.frag", {});
  unsetenv("COIF_SHADER_DIR");
  std::filesystem::remove(folder);
  ASSERT_FALSE(missing.ok());
  EXPECT_EQ(missing.error().code, ErrorCode::NotFound);
  EXPECT_EQ(missing.error().file, "strand.frag");
}

TEST(Png, ReadsBackAsWritten) {
  Image image{5, 3, {}};
  for (int i = 0; i < 60; ++i) image.rgba.push_back(std::uint8_t(mix64(std::uint64_t(i))));
  const auto png = encodePng(image);
  ASSERT_TRUE(png.ok());
  int width = 0, height = 0, channels = 0;
  stbi_uc* pixels = stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(png->data()), int(png->size()),
                                          &width, &height, &channels, 4);
  ASSERT_NE(pixels, nullptr);
  EXPECT_EQ(width, 5);
  EXPECT_EQ(height, 3);
  EXPECT_EQ(std::memcmp(pixels, image.rgba.data(), 60), 0);
  stbi_image_free(pixels);
  image.rgba.pop_back();
  EXPECT_FALSE(encodePng(image).ok());
  EXPECT_FALSE(encodePng(Image{}).ok());
}

TEST(CameraFraming, SeesTheWholeBoxFromEverywhere) {
  const Box box{Vec3(-1, 3, -2), Vec3(4, 4, 7)};
  for (const UpAxis axis : {UpAxis::Y, UpAxis::Z}) {
    for (double azimuth = -180; azimuth < 180; azimuth += 25) {
      for (const double elevation : {-80.0, 0.0, 40.0, 90.0}) {
        const Camera camera = frameBox(box, axis, azimuth, elevation, 1.5);
        const auto view = makeView(camera, box, 300, 200);
        ASSERT_TRUE(view.ok());
        const Mat4f clip = clipFromWorld(*view, Vec2::Zero());
        float reach = 0;
        for (int c = 0; c < 8; ++c) {
          const Vec4f p = clip * Vec4f(c & 1 ? 4.f : -1.f, c & 2 ? 4.f : 3.f, c & 4 ? 7.f : -2.f, 1);
          EXPECT_GT(p.w(), 0);
          EXPECT_LE(std::abs(p.z()), p.w());
          reach = std::max({reach, std::abs(p.x()) / p.w(), std::abs(p.y()) / p.w()});
        }
        EXPECT_NEAR(reach, 1 / 1.06, 1e-3);  // the margin, and float
      }
    }
  }
  const Camera front = frameBox(box, UpAxis::Z, 0, 0), side = frameBox(box, UpAxis::Y, 90, 0);
  EXPECT_LT(front.eye.y(), -10);
  EXPECT_GT(side.eye.x(), 10);
}

TEST(LightVolume, SweepsAUniformFogExactly) {
  LightVolume grid;
  grid.nx = 40, grid.ny = 30, grid.nz = 20;
  const std::vector<float> fog(std::size_t(grid.nx) * grid.ny * grid.nz, 0.1f);
  const auto at = [&](const std::vector<float>& depth, int x, int y, int z) {
    return depth[(std::size_t(z) * grid.ny + y) * grid.nx + x];
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      Vec3 direction = Vec3::Zero();
      direction[axis] = sign;
      const auto depth = sweepOpticalDepth(grid, fog, direction, {});
      const int cell[3] = {17, 11, 8}, size[3] = {40, 30, 20};
      const double before = sign > 0 ? size[axis] - 1 - cell[axis] : cell[axis];
      EXPECT_NEAR(at(depth, 17, 11, 8), 0.1 * (before + 0.5), 1e-5);  // 40 sums in float
    }
  }
  // Oblique, the way to the top stays inside: the distance is longer by 1 / cos.
  const Vec3 oblique = Vec3(0.3, -0.2, 1).normalized();
  EXPECT_NEAR(at(sweepOpticalDepth(grid, fog, oblique, {}), 20, 15, 10), 0.1 * 9.5 / oblique.z(), 1e-5);
}

}  // namespace
}  // namespace coif::preview
