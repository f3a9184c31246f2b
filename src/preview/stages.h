// What a picture says of its stages.
#pragma once

#include <epoxy/gl.h>

#include <string>
#include <utility>

#include "coif/preview/preview.h"

namespace coif::preview {

/// A stage of the picture; valid until the next one is reported.
inline StageReport& report(Picture& picture, const char* name, StageState state, std::string reason,
                           std::uint64_t bytes = 0) {
  StageReport& stage = picture.stages.emplace_back();
  stage.name = name;
  stage.state = state;
  stage.reason = std::move(reason);
  stage.bytes = bytes;
  return stage;
}

/// Times a stage; with `measure` the GPU is waited for.
class StageTimer {
 public:
  StageTimer(StageReport& stage, bool measure) : stage_(stage), measure_(measure) {}
  ~StageTimer() {
    if (measure_) glFinish();
    stage_.seconds = watch_.seconds();
  }

 private:
  StageReport& stage_;
  bool measure_;
  Stopwatch watch_;
};

}  // namespace coif::preview
