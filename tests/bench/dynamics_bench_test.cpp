// The dynamics bench runs, its bars hold, and its errors fall with the time step.
#include <gtest/gtest.h>

#include "bench/bench.h"

namespace coif {
namespace {

TEST(DynamicsBench, BarsHoldAndErrorsFallWithTheStep) {
  BenchOptions options;
  options.quick = true;
  const auto report = runBench("dynamics", options);
  ASSERT_TRUE(report.ok()) << report.error().text();
  for (const BenchFigure& figure : report->figures) {
    EXPECT_TRUE(figure.holds()) << figure.name << ' ' << figure.value;
  }
  ASSERT_FALSE(report->plots.empty());
  const BenchPlot& tip = report->plots[0];
  ASSERT_EQ(tip.name, "dynamics-tip-limp");
  for (std::size_t i = 0; i + 1 < tip.samples.size(); i += 2) {  // 1/120, then 1/480
    EXPECT_LT(tip.samples[i + 1].error, tip.samples[i].error) << tip.samples[i].method;
  }
}

}  // namespace
}  // namespace coif
