// Pictures in a window: the little OpenGL that an application with a window of its own needs from this room.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "coif/base/result.h"
#include "coif/base/vec.h"
#include "coif/light/image.h"

namespace coif {

/// Lives in the window's own context, which must be current on the calling thread for every call and when it
/// dies.
class WindowCanvas {
 public:
  /// Errors: Unsupported where the context is not OpenGL 3.3 or later, with what it is.
  static Result<WindowCanvas> create();
  WindowCanvas(WindowCanvas&&) noexcept;
  WindowCanvas& operator=(WindowCanvas&&) noexcept;
  ~WindowCanvas();

  /// Fills the window's framebuffer, in pixels.
  void clear(int width, int height, const Vec3f& color);
  /// Makes the image the texture's content; linear filtering.
  void upload(const Image& image);
  /// Name of the texture; 0 before the first upload.
  std::uint32_t texture() const;
  /// The window's framebuffer as it is drawn now.
  Image read(int width, int height) const;
  /// Whether the driver has reset the context, so that all it held is gone. Never, where it was not asked to
  /// tell (GL_LOSE_CONTEXT_ON_RESET) or cannot.
  bool contextLost() const;
  const std::string& renderer() const;  ///< the driver's name for itself

 private:
  struct Impl;
  explicit WindowCanvas(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace coif
