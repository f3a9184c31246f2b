// The bench of the preview runs, names its device and uploads no strand when the mesh moves.
#include <gtest/gtest.h>

#include "bench/bench.h"

namespace coif {
namespace {

TEST(GpuBench, NamesItsDeviceAndItsFiguresHold) {
  BenchOptions options;
  options.quick = true;
  std::vector<std::string> told;
  options.onFigure = [&](const BenchFigure& figure) { told.push_back(figure.name); };
  const auto report = runBench("gpu", options);
  if (!report.ok() && report.error().code == ErrorCode::NotFound) GTEST_SKIP() << "built without the preview";
  ASSERT_TRUE(report.ok()) << report.error().text();
  if (report->figures.empty()) GTEST_SKIP() << report->about;
  EXPECT_NE(report->about.find("Device: "), std::string::npos);
  ASSERT_EQ(report->plots.size(), 1u);
  EXPECT_LT(report->plots[0].samples[4].error, report->plots[0].samples[0].error)
      << "half of the strands look more like all than a fiftieth does";
  ASSERT_EQ(told.size(), report->figures.size());
  for (const BenchFigure& figure : report->figures) {
    EXPECT_EQ(figure.name, told[std::size_t(&figure - report->figures.data())]);
    EXPECT_TRUE(figure.holds()) << figure.name << ' ' << figure.value;
    EXPECT_GE(figure.value, 0) << figure.name;
  }
}

TEST(GpuBench, BeginsNoRowPastItsBudgetAndSaysSo) {
  BenchOptions options;
  options.quick = true;
  options.budgetSeconds = 1e-9;
  const auto report = runBench("gpu", options);
  if (!report.ok() && report.error().code == ErrorCode::NotFound) GTEST_SKIP() << "built without the preview";
  ASSERT_TRUE(report.ok()) << report.error().text();
  if (report->about.find("Device: ") == std::string::npos) GTEST_SKIP() << report->about;
  EXPECT_TRUE(report->figures.empty());
  EXPECT_NE(report->about.find("Left out, since the budget was spent"), std::string::npos) << report->about;
}

}  // namespace
}  // namespace coif
