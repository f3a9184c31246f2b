// The benches of the strands room run, and their figures hold.
#include <gtest/gtest.h>

#include "bench/bench.h"

namespace coif {
namespace {

TEST(StrandsBench, FiguresOfCoordinatesAndSamplingHold) {
  BenchOptions options;
  options.quick = true;
  for (const char* name : {"coordinates", "strands"}) {
    const auto report = runBench(name, options);
    ASSERT_TRUE(report.ok()) << report.error().text();
    EXPECT_FALSE(report->plots.empty());
    for (const BenchFigure& figure : report->figures) {
      EXPECT_TRUE(figure.holds()) << name << ": " << figure.name << ' ' << figure.value;
    }
  }
}

}  // namespace
}  // namespace coif
