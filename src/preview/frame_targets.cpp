#include <cstring>

#include "preview/passes.h"

namespace coif::preview {

Result<FrameTargets> FrameTargets::create(int width, int height) {
  FrameTargets t;
  t.width_ = width;
  t.height_ = height;
  t.color_ = makeTexture2d(GL_RGBA16F, width, height, kSamples);
  t.depth_ = makeTexture2d(GL_DEPTH_COMPONENT32F, width, height, kSamples);
  t.sum_ = makeTexture2d(GL_RGBA32F, width, height);
  t.bytes_ = makeTexture2d(GL_RGBA8, width, height);
  t.subframe_ = makeFramebuffer();
  glNamedFramebufferTexture(t.subframe_.name(), GL_COLOR_ATTACHMENT0, t.color_.name(), 0);
  glNamedFramebufferTexture(t.subframe_.name(), GL_DEPTH_ATTACHMENT, t.depth_.name(), 0);
  t.total_ = makeFramebuffer();
  glNamedFramebufferTexture(t.total_.name(), GL_COLOR_ATTACHMENT0, t.sum_.name(), 0);
  t.last_ = makeFramebuffer();
  glNamedFramebufferTexture(t.last_.name(), GL_COLOR_ATTACHMENT0, t.bytes_.name(), 0);
  for (const Framebuffer* framebuffer : {&t.subframe_, &t.total_, &t.last_}) {
    if (glCheckNamedFramebufferStatus(framebuffer->name(), GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
      return makeError(ErrorCode::TooLarge, "the driver cannot hold a picture of this size");
    }
  }
  return t;
}

void FrameTargets::clear() const {
  clearColor(sum_, {0, 0, 0, 0});
}

void FrameTargets::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, subframe_.name());
  glViewport(0, 0, width_, height_);
}

void FrameTargets::begin() const {
  bind();
  glEnable(GL_MULTISAMPLE);
  const float nothing[4] = {0, 0, 0, 0}, farthest = 1;
  glDepthMask(GL_TRUE);
  glClearNamedFramebufferfv(subframe_.name(), GL_COLOR, 0, nothing);
  glClearNamedFramebufferfv(subframe_.name(), GL_DEPTH, 0, &farthest);
}

void FrameTargets::accumulate(const Programs& programs, const VertexArray& empty, double shoulder) const {
  glBindFramebuffer(GL_FRAMEBUFFER, total_.name());
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  glUseProgram(programs[ProgramId::Resolve]);
  glUniform1i(0, kSamples);
  glUniform1f(1, float(shoulder));
  glBindTextureUnit(0, color_.name());
  glBindVertexArray(empty.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glDisable(GL_BLEND);
}

Image FrameTargets::finish(const Programs& programs, const VertexArray& empty, int subframes) const {
  glBindFramebuffer(GL_FRAMEBUFFER, last_.name());
  glUseProgram(programs[ProgramId::Finish]);
  glUniform1f(0, 1.0f / float(subframes));
  glBindTextureUnit(0, sum_.name());
  glBindVertexArray(empty.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  Image image{width_, height_, std::vector<std::uint8_t>(std::size_t(width_) * height_ * 4)};
  std::vector<std::uint8_t> rows(image.rgba.size());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glGetTextureImage(bytes_.name(), 0, GL_RGBA, GL_UNSIGNED_BYTE, GLsizei(rows.size()), rows.data());
  const std::size_t stride = std::size_t(width_) * 4;
  for (int y = 0; y < height_; ++y) {
    std::memcpy(&image.rgba[std::size_t(y) * stride], &rows[std::size_t(height_ - 1 - y) * stride], stride);
  }
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  return image;
}

}  // namespace coif::preview
