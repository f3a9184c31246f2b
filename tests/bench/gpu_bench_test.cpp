// The bench of the preview runs, names its device and uploads no strand when the mesh moves.
#include <gtest/gtest.h>

#include "bench/bench.h"

namespace coif {
namespace {

TEST(GpuBench, NamesItsDeviceAndItsFiguresHold) {
  BenchOptions options;
  options.quick = true;
  const auto report = runBench("gpu", options);
  if (!report.ok() && report.error().code == ErrorCode::NotFound) GTEST_SKIP() << "built without the preview";
  ASSERT_TRUE(report.ok()) << report.error().text();
  if (report->figures.empty()) GTEST_SKIP() << report->about;
  EXPECT_NE(report->about.find("Device: "), std::string::npos);
  ASSERT_EQ(report->plots.size(), 1u);
  EXPECT_LT(report->plots[0].samples[4].error, report->plots[0].samples[0].error)
      << "half of the strands look more like all than a fiftieth does";
  for (const BenchFigure& figure : report->figures) {
    EXPECT_TRUE(figure.holds()) << figure.name << ' ' << figure.value;
    EXPECT_GE(figure.value, 0) << figure.name;
  }
}

}  // namespace
}  // namespace coif
