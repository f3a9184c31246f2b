#include "preview/eye_layers.h"

#include <algorithm>

namespace coif::preview {
namespace {

constexpr std::size_t kLayerBytes = 20, kLayers = 8;  // as shaders/eye_layers.glsl has them

ProgramSource pass(const char* name) {
  return {"eye_layers.comp", "", {name}};
}
const ProgramSource kCompose{"fullscreen.vert", "eye_compose.frag", {"COMPOSE_LAYERS"}};

void placeUniforms(const EyeScene& scene, int firstRow, int endRow) {
  glUniform1i(1, firstRow);
  glUniform1i(2, endRow);
  glUniform1f(3, float(scene.layerSize));
}

}  // namespace

EyeLayers::EyeLayers(int width, int height) : width_(width), height_(height) {
  GLint64 most = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
  const std::size_t row = std::size_t(width) * kLayers * kLayerBytes;
  rows_ = int(
      std::clamp<std::size_t>(std::size_t(std::max<GLint64>(most, 1 << 24)) / row, 1, std::size_t(height)));
  const std::size_t pixels = std::size_t(width) * std::size_t(rows_);
  nearest_ = emptyBuffer(pixels * 4);
  layers_ = emptyBuffer(pixels * kLayers * kLayerBytes);
  headDepths_ = emptyBuffer(pixels * 16);
}

std::vector<ProgramSource> EyeLayers::programs() {
  return {pass("LAYERS_HEAD"), pass("LAYERS_NEAREST"), pass("LAYERS_ADD"), kCompose};
}

void EyeLayers::draw(const EyeScene& scene) const {
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, nearest_.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, layers_.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, headDepths_.name());
  for (int firstRow = 0; firstRow < height_; firstRow += rows_) {
    const int endRow = std::min(firstRow + rows_, height_);
    addUp(scene, firstRow, endRow);
    compose(scene, firstRow, endRow);
  }
}

void EyeLayers::addUp(const EyeScene& scene, int firstRow, int endRow) const {
  const auto use = [&](const char* name) {
    glUseProgram(scene.programs(pass(name)));
    placeUniforms(scene, firstRow, endRow);
  };
  fill(nearest_, ~0u);
  fill(layers_, 0);
  use("LAYERS_HEAD");
  glUniform2f(4, float(scene.view.nearest), float(scene.view.farthest));
  glBindTextureUnit(0, scene.targets.depth());
  dispatchInvocations(std::size_t(width_) * std::size_t(endRow - firstRow));
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  use("LAYERS_NEAREST");
  scene.strands.dispatchPoints();
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  use("LAYERS_ADD");
  scene.strands.dispatchPoints();
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void EyeLayers::compose(const EyeScene& scene, int firstRow, int endRow) const {
  scene.targets.bind();
  glUseProgram(scene.programs(kCompose));
  placeUniforms(scene, firstRow, endRow);
  glUniform2f(4, float(scene.view.nearest), float(scene.view.farthest));
  glEnable(GL_SCISSOR_TEST);
  glScissor(0, firstRow, width_, endRow - firstRow);
  glDepthFunc(GL_ALWAYS);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glBindVertexArray(scene.empty.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glDisable(GL_BLEND);
  glDepthFunc(GL_LESS);
  glDisable(GL_SCISSOR_TEST);
}

}  // namespace coif::preview
