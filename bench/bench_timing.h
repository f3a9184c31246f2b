// Included by bench.h.
#pragma once

#include <algorithm>

#include "coif/base/report.h"

namespace coif {

template <class Call>
double fastestSeconds(const Call& call) {
  constexpr double kEnough = 0.1;
  constexpr int kMost = 20;
  double fastest = 0, spent = 0;
  for (int i = 0; i < kMost && (i < 2 || spent < kEnough); ++i) {
    const Stopwatch watch;
    call();
    const double seconds = watch.seconds();
    fastest = i == 0 ? seconds : std::min(fastest, seconds);
    spent += seconds;
    if (i == 0 && seconds > kEnough) break;
  }
  return fastest;
}

}  // namespace coif
