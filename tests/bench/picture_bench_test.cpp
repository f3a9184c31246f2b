// The bench of the picture runs, and its pictures are like the path tracer's.
#include <gtest/gtest.h>

#include "bench/bench.h"

namespace coif {
namespace {

TEST(PictureBench, ItsPicturesAreLikeTheTracedOnes) {
  BenchOptions options;
  options.quick = true;
  const auto report = runBench("picture", options);
  if (!report.ok() && report.error().code == ErrorCode::NotFound) GTEST_SKIP() << "built without the preview";
  ASSERT_TRUE(report.ok()) << report.error().text();
  if (report->figures.empty()) GTEST_SKIP() << report->about;
  for (const BenchFigure& figure : report->figures) {
    EXPECT_TRUE(figure.holds()) << figure.name << ' ' << figure.value;
    // Few samples and small pictures: the truth's own noise is on top. Unlit hair is 0.16 and more away.
    if (figure.name.find("FLIP of") != std::string::npos) {
      EXPECT_LT(figure.value, 0.15) << figure.name;
    }
  }
}

}  // namespace
}  // namespace coif
