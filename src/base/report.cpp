#include "coif/base/report.h"

#include <chrono>

namespace coif {

namespace {
std::int64_t nowNs() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}
}  // namespace

const char* name(StageState state) {
  switch (state) {
    case StageState::Ran:
      return "ran";
    case StageState::Reused:
      return "reused";
    case StageState::Skipped:
      return "skipped";
  }
  return "?";
}

Stopwatch::Stopwatch() : startNs_(nowNs()) {}
double Stopwatch::seconds() const {
  return double(nowNs() - startNs_) * 1e-9;
}

}  // namespace coif
