#include "command.h"

#include <unistd.h>

#include <cstdio>
#include <iostream>
#include <memory>

#include "coif/base/report.h"

namespace coif::cli {

namespace {

bool progressShown = false;  // of the terminal, which there is one of

const char* codeName(ErrorCode code) {
  switch (code) {
    case ErrorCode::InvalidArgument:
      return "invalid-argument";
    case ErrorCode::NotFound:
      return "not-found";
    case ErrorCode::Unreadable:
      return "unreadable";
    case ErrorCode::Malformed:
      return "malformed";
    case ErrorCode::Unsupported:
      return "unsupported";
    case ErrorCode::Degenerate:
      return "degenerate";
    case ErrorCode::TooLarge:
      return "too-large";
    case ErrorCode::Cancelled:
      return "cancelled";
  }
  return "?";
}

}  // namespace

Context Session::context() const {
  Context out;
  out.threads = threads;
  if (quiet || isatty(STDERR_FILENO) == 0) return out;
  const auto watch = std::make_shared<Stopwatch>();
  out.progress = [watch](std::string_view what, double fraction) {
    if (watch->seconds() < 1) return;
    std::fprintf(stderr, "\r\033[K%.*s %3.0f %%", int(what.size()), what.data(), 100 * fraction);
    std::fflush(stderr);
    progressShown = true;
  };
  return out;
}

void endProgress() {
  if (progressShown) std::fprintf(stderr, "\r\033[K");
  progressShown = false;
}

void Session::fail(const Error& error) {
  endProgress();
  std::cerr << "coif: " << error.text() << "\n";
  if (json) {
    const nlohmann::ordered_json fault = {{"code", codeName(error.code)},
                                          {"message", error.message},
                                          {"file", error.file},
                                          {"place", error.place}};
    finish({{"error", fault}});
  }
  exit = Exit::InputFault;
}

void Session::usage(const std::string& sentence) {
  endProgress();
  std::cerr << "coif: " << sentence << "\n";
  exit = Exit::BadUsage;
}

void Session::say(const std::string& line) const {
  endProgress();
  if (!quiet && !json) std::cout << line << "\n";
}

void Session::finish(const nlohmann::ordered_json& value) const {
  endProgress();
  if (json) std::cout << value.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << "\n";
}

}  // namespace coif::cli
