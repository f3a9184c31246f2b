// The window: GLFW and Dear ImGui from start to end, and when to draw.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "coif/base/result.h"
#include "coif/preview/window_canvas.h"
#include "input_queue.h"
#include "keys.h"

struct GLFWwindow;

namespace coif::studio {

class Window {
 public:
  /// Where the window stands and how large it is, as the window system counts; the size when not maximised.
  struct Place {
    int x = -1, y = -1, width = 1280, height = 800;  ///< x, y below 0: wherever
    bool maximised = false;
  };
  /// Errors: Unsupported, in a sentence, where there is no display or no OpenGL 3.3.
  static Result<std::unique_ptr<Window>> open(const Place& place, const std::string& layoutFile);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  struct Calls {
    std::function<bool()> frame;     ///< false: end
    std::function<bool()> mayClose;  ///< asked when the window is closed
    std::function<void()> lost;      ///< the context was lost: keep what must not be; the window is made anew
  };
  /// Draws frames until one returns false or the window may close. Sleeps between events: an idle window
  /// draws nothing. A few frames follow each event, so that what it started comes to rest. A minimised window
  /// goes on with its work and is not drawn. Errors: Unsupported where a lost context could not be made anew.
  Status run(const Calls& calls);
  /// Handled as a context that the driver has lost, from the next frame on.
  void loseContext() { lost_ = true; }
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
  Place place() const;
  float scale() const { return scale_; }
  void setTheme(bool light);  ///< from the next frame on
  std::uint64_t framesDrawn() const { return frames_; }

 private:
  Window() = default;
  Status make(const Place& place);  ///< the window itself, its context and what lives in it
  void listen();
  void handInput();
  void destroy();
  Status rebuild();
  bool contextLost();
  void refreshTheme();
  GLFWwindow* window_ = nullptr;
  std::unique_ptr<WindowCanvas> canvas_;
  InputQueue input_;
  Keys keys_;
  std::array<bool, 5> buttons_{};  // down, as far as frames have seen
  Vec2f pointer_ = Vec2f::Zero();  // where frames have seen it
  std::vector<std::string> dropped_;
  std::string title_, layoutFile_;
  float scale_ = 1;
  bool light_ = false, themeOld_ = true, lost_ = false;
  Place lastPlace_;     // while it was neither maximised nor minimised
  double timeout_ = 0;  // 0: sleep until something happens
  std::uint64_t frames_ = 0;
};

}  // namespace coif::studio
