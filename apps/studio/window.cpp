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

Result<std::unique_ptr<Window>> Window::open(int width, int height, const std::string& layoutFile) {
  if (!glfwInit()) return unsupported("no window can be opened");
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  std::unique_ptr<Window> self(new Window);
  self->window_ = glfwCreateWindow(width, height, "Coif Studio", nullptr, nullptr);
  if (self->window_ == nullptr) return unsupported("no window with OpenGL 3.3 can be opened");
  glfwSetWindowSizeLimits(self->window_, 200, 100, GLFW_DONT_CARE, GLFW_DONT_CARE);
  glfwMakeContextCurrent(self->window_);
  glfwSwapInterval(1);
  COIF_ASSIGN(WindowCanvas canvas, WindowCanvas::create());
  self->canvas_ = std::make_unique<WindowCanvas>(std::move(canvas));
  glfwSetWindowUserPointer(self->window_, self.get());
  glfwSetDropCallback(self->window_, [](GLFWwindow* window, int count, const char** paths) {
    auto* to = static_cast<Window*>(glfwGetWindowUserPointer(window));
    to->dropped_.insert(to->dropped_.end(), paths, paths + count);
  });

  // Before Dear ImGui's own, which calls this one on.
  glfwSetKeyCallback(self->window_, [](GLFWwindow* window, int key, int, int action, int modifiers) {
    constexpr int kShown = GLFW_MOD_CONTROL | GLFW_MOD_SHIFT | GLFW_MOD_ALT;
    if (action == GLFW_RELEASE) return;
    static_cast<Window*>(glfwGetWindowUserPointer(window))->keys_.down(key, modifiers & kShown);
  });
  glfwSetCharCallback(self->window_, [](GLFWwindow* window, unsigned codepoint) {
    static_cast<Window*>(glfwGetWindowUserPointer(window))->keys_.character(codepoint);
  });

  ImGui::CreateContext();
  self->layoutFile_ = layoutFile;
  ImGui::GetIO().IniFilename = layoutFile.empty() ? nullptr : self->layoutFile_.c_str();
  float x = 1, y = 1;
  glfwGetWindowContentScale(self->window_, &x, &y);
  self->scale_ = x > 0 ? x : 1;
  ImGui::GetIO().ConfigInputTextCursorBlink = false;  // a blinking cursor would draw an idle window
  glfwSetWindowContentScaleCallback(self->window_, [](GLFWwindow* window, float to, float) {
    auto* of = static_cast<Window*>(glfwGetWindowUserPointer(window));
    of->scale_ = to > 0 ? to : 1;
    of->themeOld_ = true;
  });
  ImGui_ImplGlfw_InitForOpenGL(self->window_, true);
  ImGui_ImplOpenGL3_Init("#version 330");
  return self;
}

Window::~Window() {
  canvas_.reset();
  if (ImGui::GetCurrentContext() != nullptr) {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
  }
  if (window_ != nullptr) glfwDestroyWindow(window_);
  glfwTerminate();
}

void Window::run(const std::function<bool()>& frame, const std::function<bool()>& mayClose) {
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
    if (glfwWindowShouldClose(window_)) {
      if (mayClose()) break;
      glfwSetWindowShouldClose(window_, GLFW_FALSE);
    }
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    if (width == 0 || height == 0 || glfwGetWindowAttrib(window_, GLFW_ICONIFIED)) continue;
    refreshTheme();
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    go = frame();
    keys_.clear();
    ImGui::Render();
    canvas_->clear(width, height, Vec3f(0.08f, 0.08f, 0.09f));
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    glfwSwapBuffers(window_);
    ++frames_;
    if (ImGui::IsAnyMouseDown()) wakeWithin(0.05);  // held buttons repeat
  }
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

std::pair<int, int> Window::size() const {
  int width = 0, height = 0;
  glfwGetWindowSize(window_, &width, &height);
  return {width, height};
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
