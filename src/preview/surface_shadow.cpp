#include "preview/surface_shadow.h"

#include <algorithm>

#include "preview/compute.h"

namespace coif::preview {
namespace {

constexpr double kLeast = 0.7, kMost = 4;  // texels that light is spread by

ProgramSource lightPass(const std::vector<std::string>& mapDefines) {
  ProgramSource source{"surface_shadow.comp", "", {"SURFACE_LIGHT"}};
  source.defines.insert(source.defines.end(), mapDefines.begin(), mapDefines.end());
  return source;
}
const ProgramSource kBlur{"surface_shadow.comp", "", {"SURFACE_BLUR"}};

void compute(const Texture& result, int size) {
  glBindImageTexture(0, result.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R16F);
  dispatchSquare(size);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
}

}  // namespace

bool SurfaceShadow::usedBy(const VisibilityOptions& options) {
  return options.method != VisibilityMethod::None && options.method != VisibilityMethod::LightMap;
}

std::vector<ProgramSource> SurfaceShadow::programs() {
  std::vector<ProgramSource> all{kBlur};
  for (const auto& defines : mapQueryPermutations()) {
    if (defines.front() != "VISIBILITY_NONE") all.push_back(lightPass(defines));
  }
  return all;
}

SurfaceShadow::SurfaceShadow(const Programs& programs, const HairMap& map, const Texture& headDepth,
                             double spread) {
  const int size = std::max(map.view().size / 2, 1);
  light_ = makeTexture2d(GL_R16F, size, size, 0, GL_LINEAR);
  const Texture half = makeTexture2d(GL_R16F, size, size);
  glBindTextureUnit(1, headDepth.name());
  glUseProgram(programs(lightPass(mapDefines(map.options()))));
  compute(light_, size);
  glUseProgram(programs(kBlur));
  glUniform1f(1, float(std::clamp(spread / (2 * map.view().texel), kLeast, kMost)));
  glBindTextureUnit(0, light_.name());
  glUniform2i(0, 1, 0);
  compute(half, size);
  glBindTextureUnit(0, half.name());
  glUniform2i(0, 0, 1);
  compute(light_, size);
}

void SurfaceShadow::bind() const {
  glBindTextureUnit(8, light_.name());
}

}  // namespace coif::preview
