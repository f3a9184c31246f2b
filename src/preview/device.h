// The OpenGL context with its programs, shared by a Preview and its sessions.
#pragma once

#include <memory>

#include "preview/context_egl.h"
#include "preview/program.h"

namespace coif::preview {

struct Device {
  std::unique_ptr<EglContext> gl;
  std::unique_ptr<Programs> programs;
  VertexArray empty;
  std::size_t mostBatchPoints = 0, mostRawPoints = 0;

  Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  ~Device() {
    if (gl == nullptr || !gl->makeCurrent().ok()) return;
    programs.reset();
    empty = {};
    gl->release();
  }
};

}  // namespace coif::preview
