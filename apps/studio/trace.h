// --trace FILE: how long each part of a frame took, and what it moved, in Chrome's trace format.
#pragma once

#include <chrono>
#include <filesystem>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "coif/base/result.h"

namespace coif::studio {

/// Spans may end on any thread.
class Trace {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// Times count from `begin`.
  Trace(std::filesystem::path file, Time begin) : file_(std::move(file)), begin_(begin) {}
  bool on() const { return !file_.empty(); }
  Status write() const;

  using Notes = std::vector<std::pair<std::string, double>>;

  /// One span, from its construction to its end.
  class Span {
   public:
    Span(Trace& trace, const char* name) : trace_(trace), name_(name), start_(Clock::now()) {}
    ~Span() { trace_.add(name_, start_, Clock::now(), std::move(notes_)); }
    Span(const Span&) = delete;
    Span& operator=(const Span&) = delete;
    /// A number that the trace shows with the span: bytes, counts.
    void note(std::string what, double value) {
      if (trace_.on()) notes_.push_back({std::move(what), value});
    }

   private:
    friend class Trace;
    using Clock = std::chrono::steady_clock;
    Trace& trace_;
    const char* name_;
    Clock::time_point start_;
    Notes notes_;
  };

 private:
  void add(const char* name, Time start, Time end, Notes notes);
  struct Event {
    const char* name;
    std::size_t thread;
    double startUs, lengthUs;
    Notes notes;
  };
  std::filesystem::path file_;
  Time begin_;
  mutable std::mutex mutex_;
  std::vector<Event> events_;
};

}  // namespace coif::studio
