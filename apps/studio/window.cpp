#include "window.h"

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

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

  // Before Dear ImGui's own, which calls this one on.
  glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int, int action, int modifiers) {
    constexpr int kShown = GLFW_MOD_CONTROL | GLFW_MOD_SHIFT | GLFW_MOD_ALT;
    if (action == GLFW_RELEASE) return;
    static_cast<Window*>(glfwGetWindowUserPointer(window))->keys_.down(key, modifiers & kShown);
  });
  glfwSetCharCallback(window_, [](GLFWwindow* window, unsigned codepoint) {
    static_cast<Window*>(glfwGetWindowUserPointer(window))->keys_.character(codepoint);
  });
  float x = 1, y = 1;
  glfwGetWindowContentScale(window_, &x, &y);
  scale_ = x > 0 ? x : 1;
  themeOld_ = true;
  glfwSetWindowContentScaleCallback(window_, [](GLFWwindow* window, float to, float) {
    auto* of = static_cast<Window*>(glfwGetWindowUserPointer(window));
    of->scale_ = to > 0 ? to : 1;
    of->themeOld_ = true;
  });
  ImGui_ImplGlfw_InitForOpenGL(window_, true);
  ImGui_ImplOpenGL3_Init("#version 330");
  return {};
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
    ImGui::NewFrame();
    go = calls.frame();
    keys_.clear();
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
