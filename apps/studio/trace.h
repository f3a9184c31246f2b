// --trace FILE: how long each part of a frame took, in Chrome's trace format.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "coif/base/result.h"

namespace coif::studio {

class Trace {
 public:
  explicit Trace(std::filesystem::path file) : file_(std::move(file)) {}
  bool on() const { return !file_.empty(); }
  Status write() const;

  /// One span, from its construction to its end.
  class Span {
   public:
    Span(Trace& trace, const char* name) : trace_(trace), name_(name), start_(Clock::now()) {}
    ~Span() { trace_.add(name_, start_, Clock::now()); }
    Span(const Span&) = delete;
    Span& operator=(const Span&) = delete;

   private:
    friend class Trace;
    using Clock = std::chrono::steady_clock;
    Trace& trace_;
    const char* name_;
    Clock::time_point start_;
  };

 private:
  using Time = std::chrono::steady_clock::time_point;
  void add(const char* name, Time start, Time end);
  struct Event {
    const char* name;
    double startUs, lengthUs;
  };
  std::filesystem::path file_;
  Time begin_ = std::chrono::steady_clock::now();
  std::vector<Event> events_;
};

}  // namespace coif::studio
