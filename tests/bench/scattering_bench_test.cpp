// The bench of multiple scattering runs, and dual scattering is near the path tracer even in a hurry.
#include <gtest/gtest.h>

#include <algorithm>
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
  ASSERT_EQ(report->plots.size(), 3u);  // formulas; methods against time and against memory
  std::set<std::string> methods;
  for (const BenchSample& sample : report->plots[1].samples) methods.insert(sample.method);
  for (const char* method : {"path traced", "rays, straight path", "rays, hair around measured", "voxels",
                             "deep opacity", "occupancy", "sorted lists"}) {
    EXPECT_TRUE(methods.contains(method)) << method;
  }
  EXPECT_EQ(report->plots[2].against, "bytes a texel");
  for (const BenchSample& sample : report->plots[2].samples) {
    EXPECT_GT(report->plots[2].abscissa(sample), 0) << sample.method;
    const auto flicker =
        std::ranges::find(sample.measures, "flicker", &std::pair<std::string, double>::first);
    ASSERT_NE(flicker, sample.measures.end());
    EXPECT_TRUE(flicker->second > 0 && flicker->second < 1) << sample.method << flicker->second;
  }
  int asked = 0;
  for (const BenchFigure& figure : report->figures) {
    if (figure.name.starts_with("cluster") && figure.name.ends_with("off by")) {
      // the bar of the whole bench, 0.15 for blond, and the noise of 24 × 24 pixels of 64 samples
      EXPECT_LT(figure.value, 0.2) << figure.name;
      ++asked;
    }
    if (figure.name == "cluster, blond, as used: relative MSE, corrected / printed" ||
        figure.name == "cluster, blond, formulas alone at density 1: relative MSE, corrected / printed") {
      EXPECT_LT(figure.value, 1) << figure.name;
      ++asked;
    }
  }
  EXPECT_EQ(asked, 4);
}

}  // namespace
}  // namespace coif
