#include "window.h"

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <cfloat>
#include <utility>

#include "theme.h"

namespace coif::studio {
namespace {

constexpr int kFramesAfterEvent = 3;  // Dear ImGui settles hover, focus and layout within two

Error unsupported(const std::string& what) {
  const char* why = nullptr;
  glfwGetError(&why);
  return makeError(ErrorCode::Unsupported, what + (why != nullptr ? std::string(": ") + why : std::string()));
}

}  // namespace

Result<std::unique_ptr<Window>> Window::open(const Place& place, const std::string& layoutFile) {
  if (!glfwInit()) return unsupported("no window can be opened");
  std::unique_ptr<Window> self(new Window);
  ImGui::CreateContext();
  self->layoutFile_ = layoutFile;
  ImGui::GetIO().IniFilename = layoutFile.empty() ? nullptr : self->layoutFile_.c_str();
  ImGui::GetIO().ConfigInputTextCursorBlink = false;  // a blinking cursor would draw an idle window
  COIF_TRY(self->make(place));
  return self;
}

Status Window::make(const Place& place) {
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfwWindowHint(GLFW_MAXIMIZED, place.maximised ? GLFW_TRUE : GLFW_FALSE);
  // A driver that is reset says so; one that cannot is taken as it is.
  for (const int robust : {GLFW_LOSE_CONTEXT_ON_RESET, GLFW_NO_ROBUSTNESS}) {
    glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, robust);
    window_ = glfwCreateWindow(place.width, place.height, "Coif Studio", nullptr, nullptr);
    if (window_ != nullptr) break;
  }
  if (window_ == nullptr) return unsupported("no window with OpenGL 3.3 can be opened");
  lastPlace_ = place;
  if (place.x >= 0 && place.y >= 0 && !place.maximised) glfwSetWindowPos(window_, place.x, place.y);
  glfwSetWindowSizeLimits(window_, 200, 100, GLFW_DONT_CARE, GLFW_DONT_CARE);
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(1);
  COIF_ASSIGN(WindowCanvas canvas, WindowCanvas::create());
  canvas_ = std::make_unique<WindowCanvas>(std::move(canvas));
  if (!title_.empty()) glfwSetWindowTitle(window_, title_.c_str());
  glfwSetWindowUserPointer(window_, this);
  glfwSetDropCallback(window_, [](GLFWwindow* window, int count, const char** paths) {
    auto* to = static_cast<Window*>(glfwGetWindowUserPointer(window));
    to->dropped_.insert(to->dropped_.end(), paths, paths + count);
  });

  listen();
  float x = 1, y = 1;
  glfwGetWindowContentScale(window_, &x, &y);
  scale_ = x > 0 ? x : 1;
  themeOld_ = true;
  glfwSetWindowContentScaleCallback(window_, [](GLFWwindow* window, float to, float) {
    auto* of = static_cast<Window*>(glfwGetWindowUserPointer(window));
    of->scale_ = to > 0 ? to : 1;
    of->themeOld_ = true;
  });
  ImGui_ImplGlfw_InitForOpenGL(window_, false);
  ImGui_ImplOpenGL3_Init("#version 330");
  return {};
}

/// Keyboard and mouse go through the queue; what else Dear ImGui listens to goes straight to it.
void Window::listen() {
  static constexpr auto queue = [](GLFWwindow* window) -> InputQueue& {
    return static_cast<Window*>(glfwGetWindowUserPointer(window))->input_;
  };
  using Event = InputQueue::Event;
  using Kind = Event::Kind;
  glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int scancode, int action, int modifiers) {
    const Event event{Kind::Key, key, scancode, modifiers, action != GLFW_RELEASE};
    action == GLFW_REPEAT ? queue(window).pushRepeat(event) : queue(window).push(event);
  });
  glfwSetCharCallback(window_, [](GLFWwindow* window, unsigned codepoint) {
    queue(window).push({Kind::Character, int(codepoint)});
  });
  glfwSetMouseButtonCallback(window_, [](GLFWwindow* window, int button, int action, int modifiers) {
    queue(window).push({Kind::Button, button, 0, modifiers, action == GLFW_PRESS});
  });
  glfwSetCursorPosCallback(window_, [](GLFWwindow* window, double x, double y) {
    queue(window).push({.kind = Kind::Move, .x = x, .y = y});
  });
  glfwSetScrollCallback(window_, [](GLFWwindow* window, double x, double y) {
    queue(window).push({.kind = Kind::Wheel, .x = x, .y = y});
  });
  glfwSetWindowFocusCallback(window_, ImGui_ImplGlfw_WindowFocusCallback);
  glfwSetCursorEnterCallback(window_, ImGui_ImplGlfw_CursorEnterCallback);
  double x = 0, y = 0;
  glfwGetCursorPos(window_, &x, &y);
  pointer_ = {float(x), float(y)};
}

/// To the keys that Coif looks at and to Dear ImGui, whose backend would ask for the mouse's state now.
void Window::handInput() {
  ImGuiIO& io = ImGui::GetIO();
  using Kind = InputQueue::Event::Kind;
  const std::vector<InputQueue::Event> events = input_.next(io.WantTextInput);
  for (const InputQueue::Event& event : events) {
    switch (event.kind) {
      case Kind::Key:
        if (event.down) {
          keys_.down(event.code, event.modifiers & (GLFW_MOD_CONTROL | GLFW_MOD_SHIFT | GLFW_MOD_ALT));
        }
        ImGui_ImplGlfw_KeyCallback(window_, event.code, event.scancode,
                                   event.down ? GLFW_PRESS : GLFW_RELEASE, event.modifiers);
        break;
      case Kind::Character:
        keys_.character(unsigned(event.code));
        ImGui_ImplGlfw_CharCallback(window_, unsigned(event.code));
        break;
      case Kind::Button:
        if (std::size_t(event.code) < buttons_.size()) buttons_[std::size_t(event.code)] = event.down;
        break;
      case Kind::Move:
        pointer_ = {float(event.x), float(event.y)};
        break;
      case Kind::Wheel:
        ImGui_ImplGlfw_ScrollCallback(window_, event.x, event.y);
        break;
    }
  }
  for (std::size_t i = 0; i < buttons_.size(); ++i) io.MouseDown[i] = buttons_[i];
  // Else where it is now: it may have come from behind another window.
  if ((!events.empty() || !input_.empty()) && io.MousePos.x != -FLT_MAX)
    io.MousePos = {pointer_.x(), pointer_.y()};
}

void Window::destroy() {
  canvas_.reset();
  if (ImGui::GetIO().BackendRendererUserData != nullptr) ImGui_ImplOpenGL3_Shutdown();
  if (ImGui::GetIO().BackendPlatformUserData != nullptr) ImGui_ImplGlfw_Shutdown();
  if (window_ != nullptr) glfwDestroyWindow(window_);
  window_ = nullptr;
}

Window::~Window() {
  if (ImGui::GetCurrentContext() != nullptr) {
    destroy();
    ImGui::DestroyContext();
  }
  glfwTerminate();
}

bool Window::contextLost() {
  return std::exchange(lost_, false) || canvas_->contextLost();
}

/// A context that is lost stays lost, and in GLFW window and context are one.
Status Window::rebuild() {
  const Place at = place();
  destroy();
  keys_.clear();
  input_.clear();
  buttons_ = {};
  Status made = make(at);
  if (!made.ok()) {
    return makeError(ErrorCode::Unsupported, "the driver was reset, and " + made.error().message +
                                                 "; what was not saved is offered at the next start");
  }
  return made;
}

Status Window::run(const Calls& calls) {
  int pending = kFramesAfterEvent;
  bool go = true;
  while (go) {
    if (pending > 0) {
      glfwPollEvents();
      --pending;
    } else {
      timeout_ > 0 ? glfwWaitEventsTimeout(timeout_) : glfwWaitEvents();
      pending = kFramesAfterEvent;
    }
    timeout_ = 0;
    if (contextLost()) {
      calls.lost();
      COIF_TRY(rebuild());
      pending = kFramesAfterEvent;
    }
    if (glfwWindowShouldClose(window_)) {
      if (calls.mayClose()) break;
      glfwSetWindowShouldClose(window_, GLFW_FALSE);
    }
    lastPlace_ = place();
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    const bool shown = width > 0 && height > 0 && !glfwGetWindowAttrib(window_, GLFW_ICONIFIED);
    refreshTheme();
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    handInput();
    ImGui::NewFrame();
    go = calls.frame();
    keys_.clear();
    if (!input_.empty()) pending = kFramesAfterEvent;
    ImGui::Render();
    if (!shown) continue;
    canvas_->clear(width, height, Vec3f(0.08f, 0.08f, 0.09f));
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    glfwSwapBuffers(window_);
    ++frames_;
    if (ImGui::IsAnyMouseDown()) wakeWithin(0.05);  // held buttons repeat
  }
  return {};
}

void Window::setTheme(bool light) {
  themeOld_ |= light != light_;
  light_ = light;
}

void Window::refreshTheme() {
  if (!std::exchange(themeOld_, false)) return;
  applyTheme(light_, scale_);
  ImGui_ImplOpenGL3_DestroyDeviceObjects();  // made again, fonts too, by the next NewFrame
}

void Window::wake() {
  glfwPostEmptyEvent();
}

void Window::setTitle(const std::string& title) {
  if (title == title_) return;
  title_ = title;
  glfwSetWindowTitle(window_, title.c_str());
}

Window::Place Window::place() const {
  Place now = lastPlace_;
  if (window_ == nullptr) return now;  // none could be made anew
  now.maximised = glfwGetWindowAttrib(window_, GLFW_MAXIMIZED) != 0;
  if (now.maximised || glfwGetWindowAttrib(window_, GLFW_ICONIFIED) != 0) return now;
  glfwGetWindowSize(window_, &now.width, &now.height);
  glfwGetWindowPos(window_, &now.x, &now.y);
  return now;
}

Image Window::screenshot() const {
  int width = 0, height = 0;
  glfwGetFramebufferSize(window_, &width, &height);
  return canvas_->read(width, height);
}

std::vector<std::string> Window::takeDropped() {
  return std::exchange(dropped_, {});
}

}  // namespace coif::studio
