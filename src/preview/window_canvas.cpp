#include "coif/preview/window_canvas.h"

#include <algorithm>

#include "preview/gl_objects.h"

namespace coif {

using namespace preview;

struct WindowCanvas::Impl {
  Texture texture;
  int width = 0, height = 0;
  std::string renderer;
  enum class Tells { Nothing, Core, Extension } tells = Tells::Nothing;
};

Result<WindowCanvas> WindowCanvas::create() {
  const int version = epoxy_gl_version();
  if (version < 33) {
    return makeError(ErrorCode::Unsupported, "the window's OpenGL is " + std::to_string(version / 10) + "." +
                                                 std::to_string(version % 10) + ", and 3.3 is needed");
  }
  auto impl = std::make_unique<Impl>();
  if (const auto* name = reinterpret_cast<const char*>(glGetString(GL_RENDERER))) impl->renderer = name;
  if (version >= 45) {
    impl->tells = Impl::Tells::Core;
  } else if (epoxy_has_gl_extension("GL_ARB_robustness")) {
    impl->tells = Impl::Tells::Extension;
  }
  return WindowCanvas(std::move(impl));
}

WindowCanvas::WindowCanvas(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
WindowCanvas::WindowCanvas(WindowCanvas&&) noexcept = default;
WindowCanvas& WindowCanvas::operator=(WindowCanvas&&) noexcept = default;
WindowCanvas::~WindowCanvas() = default;

void WindowCanvas::clear(int width, int height, const Vec3f& color) {
  glViewport(0, 0, width, height);
  glClearColor(color.x(), color.y(), color.z(), 1);
  glClear(GL_COLOR_BUFFER_BIT);
}

void WindowCanvas::upload(const Image& image) {
  if (image.width <= 0 || image.height <= 0) return;
  const bool fits =
      impl_->texture.name() != 0 && impl_->width == image.width && impl_->height == image.height;
  if (!fits) {
    GLuint name = 0;  // not the 4.5 call: a window may have no more than 3.3
    glGenTextures(1, &name);
    impl_->texture = Texture(name);
    impl_->width = image.width, impl_->height = image.height;
  }
  glBindTexture(GL_TEXTURE_2D, impl_->texture.name());
  if (!fits) {
    for (GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER}) {
      glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
    }
    for (GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T}) {
      glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
    }
  }
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, image.width, image.height, 0, GL_RGBA, GL_UNSIGNED_BYTE,
               image.rgba.data());
  glBindTexture(GL_TEXTURE_2D, 0);
}

std::uint32_t WindowCanvas::texture() const {
  return impl_->texture.name();
}

Image WindowCanvas::read(int width, int height) const {
  Image image{width, height, std::vector<std::uint8_t>(std::size_t(width) * std::size_t(height) * 4)};
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
  const std::size_t row = std::size_t(width) * 4;
  for (int y = 0; y < height / 2; ++y) {
    std::swap_ranges(image.rgba.begin() + std::ptrdiff_t(row * y),
                     image.rgba.begin() + std::ptrdiff_t(row * (y + 1)),
                     image.rgba.begin() + std::ptrdiff_t(row * (height - 1 - y)));
  }
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 255;
  return image;
}

bool WindowCanvas::contextLost() const {
  if (impl_->tells == Impl::Tells::Nothing) return false;
  return (impl_->tells == Impl::Tells::Core ? glGetGraphicsResetStatus() : glGetGraphicsResetStatusARB()) !=
         GL_NO_ERROR;
}

const std::string& WindowCanvas::renderer() const {
  return impl_->renderer;
}

}  // namespace coif
