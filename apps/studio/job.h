// Something that takes its time, on a thread of its own, with progress and cancel: the window never waits.
#pragma once

#include <atomic>
#include <functional>
#include <future>
#include <mutex>
#include <string>

#include "coif/base/context.h"

namespace coif::studio {

/// One at a time. The work runs on the job's thread and returns what is to be done with its outcome; poll()
/// does that on the window's thread.
class Job {
 public:
  using Finish = std::function<void()>;
  using Work = std::function<Finish(const Context&)>;

  /// `wake` is called from the job's thread when there is something to show.
  explicit Job(std::function<void()> wake) : wake_(std::move(wake)) {}
  ~Job() { abandon(); }

  bool busy() const { return running_.valid(); }
  /// Requires !busy(). Gives the work `patience` seconds first, and finishes at once if they do.
  void start(std::string what, Work work, double patience = 0);
  /// Call once a frame.
  void poll();
  void cancel() { cancel_ = true; }
  /// Cancels, waits and drops the outcome.
  void abandon();

  const std::string& what() const { return what_; }
  double fraction() const { return fraction_; }  ///< in [0, 1]; below 0: not known
  double seconds() const;                        ///< since it began
  bool cancelled() const { return cancel_; }
  std::string step() const;  ///< what it is doing now

 private:
  std::function<void()> wake_;
  std::string what_;
  std::future<Finish> running_;
  std::atomic<bool> cancel_{false};
  std::atomic<double> fraction_{-1};
  double began_ = 0, shown_ = 0;
  mutable std::mutex mutex_;
  std::string step_;
};

}  // namespace coif::studio
