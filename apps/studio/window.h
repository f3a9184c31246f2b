// The window: GLFW and Dear ImGui from start to end, and when to draw.
#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "coif/base/result.h"
#include "coif/preview/window_canvas.h"
#include "keys.h"

struct GLFWwindow;

namespace coif::studio {

class Window {
 public:
  /// Errors: Unsupported, in a sentence, where there is no display or no OpenGL 3.3.
  static Result<std::unique_ptr<Window>> open(int width, int height, const std::string& layoutFile);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Draws frames by calling `frame` until it returns false or the window is closed and `mayClose` agrees.
  /// Sleeps between events: an idle window draws nothing. A few frames follow each event, so that what it
  /// started comes to rest.
  void run(const std::function<bool()>& frame, const std::function<bool()>& mayClose);
  /// Draws a frame this many seconds from now at the latest; asked for anew in each frame.
  void wakeWithin(double seconds) { timeout_ = timeout_ > 0 ? std::min(timeout_, seconds) : seconds; }
  /// Wakes run() up; from any thread.
  static void wake();

  const Keys& keys() const { return keys_; }
  WindowCanvas& canvas() { return *canvas_; }
  void setTitle(const std::string& title);
  Image screenshot() const;
  /// Paths dropped on the window since the last call.
  std::vector<std::string> takeDropped();
  std::pair<int, int> size() const;  ///< as the window system counts
  float scale() const { return scale_; }
  void setTheme(bool light);  ///< from the next frame on
  std::uint64_t framesDrawn() const { return frames_; }

 private:
  Window() = default;
  void refreshTheme();
  GLFWwindow* window_ = nullptr;
  std::unique_ptr<WindowCanvas> canvas_;
  Keys keys_;
  std::vector<std::string> dropped_;
  std::string title_, layoutFile_;
  float scale_ = 1;
  bool light_ = false, themeOld_ = true;
  double timeout_ = 0;  // 0: sleep until something happens
  std::uint64_t frames_ = 0;
};

}  // namespace coif::studio
