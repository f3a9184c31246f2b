// OpenGL names with owners.
#pragma once

#include <epoxy/gl.h>

#include <cstdint>
#include <span>
#include <utility>

namespace coif::preview {

/// Owns one GL name; Traits say how it is deleted. Needs the context current when it dies.
template <class Traits>
class GlObject {
 public:
  GlObject() = default;
  explicit GlObject(GLuint name) : name_(name) {}
  GlObject(GlObject&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  GlObject& operator=(GlObject&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  ~GlObject() {
    if (name_ != 0) Traits::destroy(name_);
  }
  GLuint name() const { return name_; }

 private:
  GLuint name_ = 0;
};

struct BufferTraits {
  static void destroy(GLuint name) { glDeleteBuffers(1, &name); }
};
struct TextureTraits {
  static void destroy(GLuint name) { glDeleteTextures(1, &name); }
};
struct RenderbufferTraits {
  static void destroy(GLuint name) { glDeleteRenderbuffers(1, &name); }
};
struct FramebufferTraits {
  static void destroy(GLuint name) { glDeleteFramebuffers(1, &name); }
};
struct VertexArrayTraits {
  static void destroy(GLuint name) { glDeleteVertexArrays(1, &name); }
};
struct ProgramTraits {
  static void destroy(GLuint name) { glDeleteProgram(name); }
};
using Buffer = GlObject<BufferTraits>;
using Texture = GlObject<TextureTraits>;
using Renderbuffer = GlObject<RenderbufferTraits>;
using Framebuffer = GlObject<FramebufferTraits>;
using VertexArray = GlObject<VertexArrayTraits>;
using Program = GlObject<ProgramTraits>;

inline Framebuffer makeFramebuffer() {
  GLuint name = 0;
  glCreateFramebuffers(1, &name);
  return Framebuffer(name);
}
inline VertexArray makeVertexArray() {
  GLuint name = 0;
  glCreateVertexArrays(1, &name);
  return VertexArray(name);
}
/// An immutable buffer of the values (at least one byte, so that it can be bound).
template <class T>
Buffer makeBuffer(std::span<const T> values, GLbitfield flags = 0) {
  GLuint name = 0;
  glCreateBuffers(1, &name);
  static const T nothing{};
  glNamedBufferStorage(name, values.empty() ? GLsizeiptr(sizeof(T)) : GLsizeiptr(values.size_bytes()),
                       values.empty() ? &nothing : values.data(), flags);
  return Buffer(name);
}
inline Texture makeTexture2d(GLenum format, int width, int height, int samples = 0,
                             GLenum filter = GL_NEAREST) {
  GLuint name = 0;
  glCreateTextures(samples > 0 ? GL_TEXTURE_2D_MULTISAMPLE : GL_TEXTURE_2D, 1, &name);
  if (samples > 0) {
    glTextureStorage2DMultisample(name, samples, format, width, height, GL_TRUE);
  } else {
    glTextureStorage2D(name, 1, format, width, height);
    glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GLint(filter));
    glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, GLint(filter));
    glTextureParameteri(name, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(name, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  }
  return Texture(name);
}

/// Fills a texture, all layers of an array, by drawing: drivers fill by glClearTexImage at a gigabyte a
/// second. Waits for what shaders wrote into it.
inline void clearColor(const Texture& texture, const float (&value)[4]) {
  const Framebuffer target = makeFramebuffer();
  glNamedFramebufferTexture(target.name(), GL_COLOR_ATTACHMENT0, texture.name(), 0);
  glMemoryBarrier(GL_FRAMEBUFFER_BARRIER_BIT);
  glClearNamedFramebufferfv(target.name(), GL_COLOR, 0, value);
}
inline void clearIntegers(const Texture& texture) {
  const GLuint nothing[4] = {0, 0, 0, 0};
  const Framebuffer target = makeFramebuffer();
  glNamedFramebufferTexture(target.name(), GL_COLOR_ATTACHMENT0, texture.name(), 0);
  glMemoryBarrier(GL_FRAMEBUFFER_BARRIER_BIT);
  glClearNamedFramebufferuiv(target.name(), GL_COLOR, 0, nothing);
}
inline void clearDepth(const Texture& texture, float value) {
  const Framebuffer target = makeFramebuffer();
  glNamedFramebufferTexture(target.name(), GL_DEPTH_ATTACHMENT, texture.name(), 0);
  glClearNamedFramebufferfv(target.name(), GL_DEPTH, 0, &value);
}

}  // namespace coif::preview
