// What a stage says of itself: did it run, why, how long, how much, and how wrong.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace coif {

enum class StageState { Ran, Reused, Skipped };

/// An error estimate with its unit and where it comes from; value < 0 means none is claimed.
struct ErrorEstimate {
  double value = -1;
  std::string unit;    ///< "of the bounding box", "relative", …
  std::string method;  ///< how it was estimated
};

/// Work that a scene did not need.
struct LeftOut {
  std::string what;     ///< "bending terms"
  std::string control;  ///< the setting that has a say in it: its switch
  std::string trigger;  ///< why it could be left out
  double share = 0;     ///< how much of `of`, above 0 to 1
  std::string of;       ///< "chains", "steps", …
};

struct StageReport {
  std::string name;
  StageState state = StageState::Ran;
  std::string reason;  ///< why it ran, was reused or was skipped
  double seconds = 0;
  std::uint64_t bytes = 0;  ///< of the stage's result
  ErrorEstimate error;
  std::vector<LeftOut> leftOut;
  std::vector<std::string> notes;  ///< counts and warnings, a sentence each
};

const char* name(StageState state);

/// Wall-clock seconds since construction.
class Stopwatch {
 public:
  Stopwatch();
  double seconds() const;

 private:
  std::int64_t startNs_;
};

}  // namespace coif
