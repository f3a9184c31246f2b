#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "coif/base/random.h"
#include "preview/context_egl.h"
#include "preview/passes.h"
#include "preview/shader_files.h"
#include "preview_fixture.h"

namespace coif::preview {
namespace {

TEST(Shaders, EveryPermutationCompilesAndEveryFileIsUsed) {
  const auto context = EglContext::create();
  if (!context.ok()) GTEST_SKIP() << context.error().text();
  ASSERT_TRUE((*context)->makeCurrent().ok());
  std::string all;
  for (const ProgramSource& source : allPermutations()) {
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
      const auto depth = sweepOpticalDepth(grid, fog, direction);
      const int cell[3] = {17, 11, 8}, size[3] = {40, 30, 20};
      const double before = sign > 0 ? size[axis] - 1 - cell[axis] : cell[axis];
      EXPECT_NEAR(at(depth, 17, 11, 8), 0.1 * (before + 0.5), 1e-5);  // 40 sums in float
    }
  }
  // Oblique, the way to the top stays inside: the distance is longer by 1 / cos.
  const Vec3 oblique = Vec3(0.3, -0.2, 1).normalized();
  EXPECT_NEAR(at(sweepOpticalDepth(grid, fog, oblique), 20, 15, 10), 0.1 * 9.5 / oblique.z(), 1e-5);
}

}  // namespace
}  // namespace coif::preview
