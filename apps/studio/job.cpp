#include "job.h"

#include <chrono>

namespace coif::studio {
namespace {

constexpr double kShowEverySeconds = 0.1;  // the bar moves in steps that cost nothing to draw

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

void Job::start(std::string what, Work work, double patience) {
  what_ = std::move(what);
  cancel_ = false;
  fraction_ = -1;
  began_ = shown_ = now();
  {
    const std::scoped_lock lock(mutex_);
    step_.clear();
  }
  running_ = std::async(std::launch::async, [this, work = std::move(work)] {
    Context context;
    context.cancel = &cancel_;
    context.progress = [this](std::string_view step, double fraction) {
      fraction_ = fraction;
      {
        const std::scoped_lock lock(mutex_);
        step_ = step;
      }
      if (now() - shown_ < kShowEverySeconds) return;
      shown_ = now();
      wake_();
    };
    Finish finish = work(context);
    wake_();
    return finish;
  });
  if (patience > 0 && running_.wait_for(std::chrono::duration<double>(patience)) == std::future_status::ready)
    poll();
}

void Job::poll() {
  if (!running_.valid() || running_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
  const Finish finish = running_.get();  // from here on another may be started, by finish itself too
  if (finish) finish();
}

void Job::abandon() {
  if (!running_.valid()) return;
  cancel_ = true;
  running_.wait();
  running_ = {};
}

double Job::seconds() const {
  return now() - began_;
}

std::string Job::step() const {
  const std::scoped_lock lock(mutex_);
  return step_;
}

}  // namespace coif::studio
