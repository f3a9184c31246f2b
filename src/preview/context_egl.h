// An OpenGL 4.5 core context without a window, and what the driver has to say about its use.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "coif/base/result.h"

namespace coif::preview {

/// Messages that the driver sent since the last clear.
struct DebugLog {
  std::vector<std::string> errors;    ///< GL errors and undefined behaviour
  std::vector<std::string> warnings;  ///< of high severity
  void clear() { errors.clear(), warnings.clear(); }
};

class EglContext {
 public:
  static Result<std::unique_ptr<EglContext>> create();
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;
  ~EglContext();

  Status makeCurrent();
  void release();
  DebugLog& log() { return log_; }
  const std::string& renderer() const { return renderer_; }
  bool software() const { return software_; }

 private:
  EglContext() = default;
  bool open(void* display, std::string& why);
  void close();

  void* display_ = nullptr;
  void* context_ = nullptr;
  DebugLog log_;
  std::string renderer_;
  bool software_ = false;
};

/// Makes the context current for a scope.
class CurrentContext {
 public:
  explicit CurrentContext(EglContext& context) : context_(context) {}
  ~CurrentContext() { context_.release(); }
  CurrentContext(const CurrentContext&) = delete;
  CurrentContext& operator=(const CurrentContext&) = delete;

 private:
  EglContext& context_;
};

}  // namespace coif::preview
