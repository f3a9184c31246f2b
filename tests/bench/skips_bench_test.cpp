// What the preview leaves out is really left out: by counts, which do not depend on the machine's load.
#include <gtest/gtest.h>

#include "bench/bench.h"

namespace coif {
namespace {

TEST(SkipsBench, EverySkipHasItsRowsAndLeavesLessToDo) {
  BenchOptions options;
  options.quick = true;
  const auto report = runBench("skips", options);
  if (!report.ok() && report.error().code == ErrorCode::NotFound) GTEST_SKIP() << "built without the preview";
  ASSERT_TRUE(report.ok()) << report.error().text();
  if (report->figures.empty()) GTEST_SKIP() << report->about;
  const char* skips[] = {"key light's map",
                         "transparency where",
                         "layers where",
                         "two colour channels",
                         "sub-frames of depth layers",
                         "strands and points",
                         "that stands still",
                         "all shadows"};
  for (const char* skip : skips) {
    int rows = 0, counted = 0;
    for (const BenchFigure& figure : report->figures) {
      if (figure.name.find(skip) == std::string::npos) continue;
      ++rows;
      if (figure.name.find(": work of ") == std::string::npos) continue;
      ++counted;
      EXPECT_TRUE(figure.holds()) << figure.name << ' ' << figure.value;
      EXPECT_GE(figure.value, 0) << figure.name;
    }
    EXPECT_EQ(rows, 3) << skip;
    EXPECT_EQ(counted, 1) << skip;
  }
  EXPECT_EQ(report->figures.size(), 3 * std::size(skips));
}

}  // namespace
}  // namespace coif
