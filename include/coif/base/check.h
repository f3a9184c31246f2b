// Broken invariants: faults of the program, not of its input. On in release.
#pragma once

#include <stdexcept>
#include <string>

namespace coif {

/// Thrown when Coif's own promise is broken; carries the condition and the place.
class InvariantError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

[[noreturn]] void failCheck(const char* condition, const char* file, int line, const std::string& detail);

}  // namespace coif

#define COIF_CHECK(condition, detail) \
  ((condition) ? void(0) : ::coif::failCheck(#condition, __FILE__, __LINE__, (detail)))
