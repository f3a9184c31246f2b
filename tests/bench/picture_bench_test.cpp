// The bench of the picture runs, and its pictures are like the path tracer's.
#include <gtest/gtest.h>

#include <filesystem>

#include "bench/bench.h"

namespace coif {
namespace {

TEST(PictureBench, ItsPicturesAreLikeTheTracedOnes) {
  BenchOptions options;
  options.quick = true;
  options.truthFolder = std::filesystem::temp_directory_path() / "coif-picture-truth";
  std::filesystem::remove_all(options.truthFolder);
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
  // The second time the traced pictures come from the folder, and nothing changes.
  std::size_t kept = 0;
  for (const auto& file : std::filesystem::directory_iterator(options.truthFolder)) {
    kept += file.path().extension() == ".exr";
  }
  EXPECT_EQ(kept, 4u) << "two halves of brown and of blond";
  const auto again = runBench("picture", options);
  ASSERT_TRUE(again.ok()) << again.error().text();
  for (std::size_t f = 0; f < report->figures.size(); ++f) {
    if (report->figures[f].name.find("FLIP") != std::string::npos) {
      EXPECT_EQ(again->figures[f].value, report->figures[f].value) << report->figures[f].name;
    }
  }
  std::filesystem::remove_all(options.truthFolder);
}

}  // namespace
}  // namespace coif
