// The shadow bench runs, its promises of accuracy hold, and its plots show what they are about.
#include <gtest/gtest.h>

#include <algorithm>

#include "bench/bench.h"

namespace coif {
namespace {

double measure(const BenchSample& sample, const std::string& name) {
  for (const auto& [key, value] : sample.measures) {
    if (key == name) return value;
  }
  return -1;
}

TEST(VisibilityBench, AccuracyHoldsAndEveryMethodIsMeasured) {
  BenchOptions options;
  options.quick = true;
  const auto report = runBench("visibility", options);
  ASSERT_TRUE(report.ok()) << report.error().text();
  int bars = 0;
  for (const BenchFigure& figure : report->figures) {
    EXPECT_TRUE(figure.holds()) << figure.name << ' ' << figure.value;
    bars += figure.kind != Bar::None;
  }
  EXPECT_EQ(bars,
            4);  // seven layers, occupancy, automatic, sorted lists; times have bars in the full run alone
  const auto bob = std::ranges::find(report->plots, "visibility-bob", &BenchPlot::name);
  ASSERT_NE(bob, report->plots.end());
  for (const BenchSample& sample : bob->samples) {
    EXPECT_GT(sample.seconds, 0) << sample.method;
    EXPECT_GT(sample.error, 0) << sample.method;
    EXPECT_GT(measure(sample, "bytes a texel"), 0) << sample.method;
    EXPECT_GE(measure(sample, "L2"), sample.error) << sample.method;  // of the same weights
    EXPECT_LE(measure(sample, "max"), 1) << sample.method;
    if (sample.method.starts_with("deep opacity") || sample.method == "occupancy") {
      EXPECT_LT(measure(sample, "error at the first fragment"), 1e-12) << sample.method;
    }
  }
}

TEST(VisibilityBench, CurvesAreDrawnOnLinearAxesAndMeasuresAreColumns) {
  BenchPlot plot;
  plot.name = "demo";
  plot.against = "depth";
  plot.curves = true;
  plot.errorUnit = "transmittance";
  for (const double depth : {0.0, 0.5, 1.0}) {
    BenchSample sample{"list", {}, 1 - depth, 0, 0};
    sample.measures = {{"depth", depth}};
    plot.samples.push_back(sample);
  }
  plot.samples.push_back({"without a depth", {}, 0.5, 0, 0});
  const std::string svg = benchSvg(plot);
  // The frame is 78 … 560 by 52 … 402: from the top left, through the middle, to the bottom right.
  EXPECT_NE(svg.find("M78.0 52.0L319.0 227.0L560.0 402.0"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_NE(benchCsv(plot).find("method,depth,error,seconds,ratio\nlist,0,1,0,0\nlist,0.5,0.5,0,0\n"),
            std::string::npos);
}

}  // namespace
}  // namespace coif
