#include "preview/context_egl.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <cstdlib>
#include <cstring>
#include <string_view>

namespace coif::preview {
namespace {

// Displays are shared by everyone in the process who asks for the same device, so they are never terminated.
std::vector<EGLDisplay> candidateDisplays(bool softwareOnly, std::string& why) {
  std::vector<EGLDisplay> displays;
  const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  if (extensions == nullptr) {
    why = "no EGL client extensions";
    return displays;
  }
  const auto has = [&](const char* name) { return std::strstr(extensions, name) != nullptr; };
  if (!softwareOnly && has("EGL_EXT_platform_device") && has("EGL_EXT_device_enumeration") &&
      has("EGL_EXT_device_query")) {
    EGLDeviceEXT devices[16];
    EGLint count = 0;
    if (eglQueryDevicesEXT(16, devices, &count)) {
      for (EGLint i = 0; i < count; ++i) {
        const char* own = eglQueryDeviceStringEXT(devices[i], EGL_EXTENSIONS);
        if (own != nullptr && std::strstr(own, "EGL_MESA_device_software") != nullptr) continue;
        displays.push_back(eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr));
      }
    }
  }
  if (has("EGL_MESA_platform_surfaceless")) {
    displays.push_back(eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
  }
  if (displays.empty()) why = "EGL offers neither EGL_EXT_platform_device nor EGL_MESA_platform_surfaceless";
  return displays;
}

void APIENTRY onMessage(GLenum, GLenum type, GLuint, GLenum severity, GLsizei length, const GLchar* text,
                        const void* user) {
  auto& log = *static_cast<DebugLog*>(const_cast<void*>(user));
  constexpr std::size_t kEnough = 20;
  const std::string message(text, length < 0 ? std::strlen(text) : std::size_t(length));
  if (type == GL_DEBUG_TYPE_ERROR || type == GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR) {
    if (log.errors.size() < kEnough) log.errors.push_back(message);
  } else if (severity == GL_DEBUG_SEVERITY_HIGH) {
    if (log.warnings.size() < kEnough) log.warnings.push_back(message);
  }
}

bool libraryPresent() {
  // epoxy aborts the process when libEGL or libGL cannot be loaded; ask first.
  return epoxy_has_egl();
}

}  // namespace

bool EglContext::open(void* display, std::string& why) {
  if (display == EGL_NO_DISPLAY) return why = "EGL gave no display", false;
  if (!eglInitialize(display, nullptr, nullptr)) return why = "eglInitialize failed", false;
  if (!epoxy_has_egl_extension(display, "EGL_KHR_surfaceless_context") ||
      !epoxy_has_egl_extension(display, "EGL_KHR_no_config_context") || !eglBindAPI(EGL_OPENGL_API)) {
    return why = "EGL cannot make an OpenGL context without a surface", false;
  }
  // A driver that is reset says so (makeCurrent looks); one that cannot is taken as it is.
  for (const EGLint strategy : {EGL_LOSE_CONTEXT_ON_RESET, EGL_NO_RESET_NOTIFICATION}) {
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                 4,
                                 EGL_CONTEXT_MINOR_VERSION,
                                 5,
                                 EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                 EGL_CONTEXT_OPENGL_DEBUG,
                                 EGL_TRUE,
                                 EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY,
                                 strategy,
                                 EGL_NONE};
    context_ = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    if (context_ != EGL_NO_CONTEXT) break;
  }
  if (context_ == EGL_NO_CONTEXT) return why = "the driver has no OpenGL 4.5 core", false;
  display_ = display;
  if (const Status status = makeCurrent(); !status.ok()) {
    why = status.error().message;
    close();
    return false;
  }
  const auto* rendererName = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  renderer_ = rendererName != nullptr ? rendererName : "";
  software_ =
      renderer_.find("llvmpipe") != std::string::npos || renderer_.find("softpipe") != std::string::npos;
  glEnable(GL_DEBUG_OUTPUT);
  glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
  glDebugMessageCallback(onMessage, &log_);
  release();
  return true;
}

Result<std::unique_ptr<EglContext>> EglContext::create() {
  if (!libraryPresent())
    return makeError(ErrorCode::Unsupported, "there is no usable EGL library on this machine");
  const char* wish = std::getenv("COIF_PREVIEW_DEVICE");
  std::string why;
  std::unique_ptr<EglContext> result(new EglContext);
  for (void* display : candidateDisplays(wish != nullptr && std::string_view(wish) == "software", why)) {
    if (result->open(display, why)) return result;
  }
  return makeError(ErrorCode::Unsupported, "no OpenGL 4.5 context without a window: " + why);
}

Status EglContext::makeCurrent() {
  // The API binding is per thread.
  if (!eglBindAPI(EGL_OPENGL_API) || !eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) {
    return makeError(ErrorCode::Unsupported, "the OpenGL context could not be made current on this thread");
  }
  if (glGetGraphicsResetStatus() != GL_NO_ERROR)
    return makeError(ErrorCode::Unsupported, "the graphics driver was reset");
  return {};
}

void EglContext::release() {
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

void EglContext::close() {
  if (context_ != nullptr) eglDestroyContext(display_, context_);
  context_ = nullptr;
}

EglContext::~EglContext() {
  close();
}

}  // namespace coif::preview
