#include "preview/sliced_hair.h"

#include <algorithm>
#include <cmath>

namespace coif::preview {
namespace {

constexpr std::size_t kGroup = 256;

/// Where the slices lie: away from light and eye, in units of a slice's thickness.
struct Slicing {
  Vec3 away;
  double first = 0;
  bool frontToBack = true;
};

Slicing sliceBox(const Box& box, const View& view, const Vec3& towardsLight, int slices) {
  const Vec3 towardsEye = (view.eye - 0.5 * (box.lo + box.hi)).stableNormalized();
  Slicing slicing;
  slicing.frontToBack = towardsLight.dot(towardsEye) >= 0;
  const Vec3 half = (towardsLight + (slicing.frontToBack ? 1.0 : -1.0) * towardsEye).stableNormalized();
  double lo = INFINITY, hi = -INFINITY;
  for (int c = 0; c < 8; ++c) {
    const Vec3 corner((c & 1 ? box.hi : box.lo).x(), (c & 2 ? box.hi : box.lo).y(),
                      (c & 4 ? box.hi : box.lo).z());
    lo = std::min(lo, -half.dot(corner));
    hi = std::max(hi, -half.dot(corner));
  }
  const double thickness = std::max((hi - lo) / slices, 1e-12 * (1 + box.hi.norm()));
  slicing.away = -half / thickness;
  slicing.first = lo / thickness;
  return slicing;
}

}  // namespace

std::vector<ProgramSource> SlicedHair::sortPrograms() {
  return {{"slices.comp", "", {}}, {"slices.comp", "", {"SCATTER"}}};
}

ProgramSource SlicedHair::lightProgram() {
  return {"shadow_line.vert", "shadow_line.frag", {"PASS_RUNNING", "SLICED"}};
}

Result<SlicedHair> SlicedHair::make(const Programs& programs, const StrandBuffers& strands, const View& view,
                                    const Vec3& towardsLight, const LightView& lightView, const Box& box,
                                    int slices) {
  if (strands.plan().batches.size() > 1)
    return makeError(
        ErrorCode::TooLarge,
        "half-angle slices hold as many strand points as one buffer of the driver does; use the level "
        "of detail or fewer strands");
  SlicedHair hair;
  hair.strands_ = &strands;
  hair.empty_ = makeVertexArray();
  hair.starts_.assign(std::size_t(slices) + 1, 0);
  const std::size_t points = strands.plan().points;
  if (points == 0) return hair;
  const Slicing slicing = sliceBox(box, view, towardsLight, slices);
  hair.frontToBack_ = slicing.frontToBack;
  const std::size_t wanted = (points + kGroup - 1) / kGroup, groups = groupsDispatched(wanted);
  const auto run = [&](const ProgramSource& source) {
    glUseProgram(programs(source));
    strands.bindPoints();
    const Vec3f away = slicing.away.cast<float>();
    glUniform1ui(0, GLuint(points));
    glUniform3fv(1, 1, away.data());
    glUniform1f(2, float(slicing.first));
    glUniform1ui(3, GLuint(slices));
    dispatchGroups(wanted);
  };
  std::vector<std::uint32_t> counts(std::size_t(slices) * groups);
  const Buffer counted = emptyBuffer(counts.size() * 4, GL_DYNAMIC_STORAGE_BIT);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 5, counted.name());
  run(sortPrograms()[0]);
  read(counted, 0, counts.data(), counts.size() * 4);
  std::uint32_t sum = 0;
  for (std::size_t s = 0; s < std::size_t(slices); ++s) {
    hair.starts_[s] = sum;
    for (std::size_t g = 0; g < groups; ++g) {
      const std::uint32_t own = counts[s * groups + g];
      counts[s * groups + g] = sum;
      sum += own;
    }
  }
  hair.starts_.back() = sum;
  write(counted, counts.data(), counts.size() * 4);
  hair.segments_ = emptyBuffer(std::max<std::size_t>(sum, 1) * 4);
  hair.shades_ = emptyBuffer(points * 16);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 7, hair.segments_.name());
  run(sortPrograms()[1]);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  hair.lightSize_ = lightView.size;
  GLuint light = 0;
  glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &light);
  glTextureStorage3D(light, 1, GL_R32F, lightView.size, lightView.size, 1);
  glTextureParameteri(light, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTextureParameteri(light, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  hair.light_ = Texture(light);
  clearColor(hair.light_, {0, 0, 0, 0});
  hair.toLight_ = makeFramebuffer();
  glNamedFramebufferTextureLayer(hair.toLight_.name(), GL_COLOR_ATTACHMENT0, light, 0, 0);
  return hair;
}

std::size_t SlicedHair::bytes() const {
  return std::size_t(starts_.back()) * 4 + strands_->plan().points * 16 +
         std::size_t(lightSize_) * std::size_t(lightSize_) * 4;
}

void SlicedHair::bind() const {
  strands_->bindPoints();
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 4, shades_.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 7, segments_.name());
}

void SlicedHair::shade(int slice) const {
  bind();
  glBindTextureUnit(3, light_.name());
  glUniform1ui(0, GLuint(2 * count(slice)));
  glUniform1ui(2, GLuint(first(slice)));
  dispatchInvocations(2 * std::size_t(count(slice)));
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void SlicedHair::addToLight(const Programs& programs, int slice) const {
  bind();
  glBindFramebuffer(GL_FRAMEBUFFER, toLight_.name());
  glViewport(0, 0, lightSize_, lightSize_);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_MULTISAMPLE);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  glUseProgram(programs(lightProgram()));
  glBindVertexArray(empty_.name());
  glDrawArrays(GL_LINES, 2 * first(slice), 2 * count(slice));
  glDisable(GL_BLEND);
  glEnable(GL_MULTISAMPLE);
  glEnable(GL_DEPTH_TEST);
}

void SlicedHair::draw(int slice) const {
  bind();
  glBindVertexArray(empty_.name());
  const bool lines = strands_->topology() == Topology::Lines;
  const int vertices = lines ? 2 : 6;
  glDrawArrays(lines ? GL_LINES : GL_TRIANGLES, vertices * first(slice), vertices * count(slice));
}

}  // namespace coif::preview
