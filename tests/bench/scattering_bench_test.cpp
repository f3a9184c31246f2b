// The bench of multiple scattering runs, and dual scattering is near the path tracer even in a hurry.
#include <gtest/gtest.h>

#include <set>

#include "bench/bench.h"

namespace coif {
namespace {

TEST(ScatteringBench, DualScatteringIsNearThePathTracer) {
  BenchOptions options;
  options.quick = true;
  const auto report = runBench("scattering", options);
  if (!report.ok() && report.error().code == ErrorCode::Unsupported) GTEST_SKIP() << report.error().text();
  ASSERT_TRUE(report.ok()) << report.error().text();
  ASSERT_EQ(report->plots.size(), 2u);
  std::set<std::string> methods;
  for (const BenchSample& sample : report->plots[1].samples) methods.insert(sample.method);
  for (const char* method :
       {"path traced", "rays", "voxels, 128 slices", "deep opacity, 4 layers", "occupancy"}) {
    EXPECT_TRUE(methods.contains(method)) << method;
  }
  for (const BenchFigure& figure : report->figures) {
    if (figure.name.starts_with("cluster") && figure.name.ends_with("off by")) {
      // the bar of the whole bench, 0.15 for blond, and the noise of 24 × 24 pixels of 64 samples
      EXPECT_LT(figure.value, 0.2) << figure.name;
    }
    if (figure.name == "cluster, blond: relative MSE, corrected / printed") {
      EXPECT_LT(figure.value, 1);
    }
  }
}

}  // namespace
}  // namespace coif
