// What a long computation needs from its caller: threads, progress, cancellation. No globals.
#pragma once

#include <atomic>
#include <functional>
#include <string_view>

namespace coif {

struct Context {
  int threads = 0;  ///< 0: all cores. Results never depend on it.
  /// Called from the computing thread with a fraction in [0, 1]; may be empty.
  std::function<void(std::string_view what, double fraction)> progress;
  const std::atomic<bool>* cancel = nullptr;  ///< set by another thread to stop early

  bool cancelled() const { return cancel != nullptr && cancel->load(std::memory_order_relaxed); }
  void report(std::string_view what, double fraction) const {
    if (progress) progress(what, fraction);
  }
};

}  // namespace coif
