#include "bench/bench.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

namespace coif {
namespace {

std::string contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream out;
  out << file.rdbuf();
  return out.str();
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++n;
  return n;
}

BenchPlot samplePlot() {
  BenchPlot plot;
  plot.name = "demo";
  plot.title = "a < b & \"c\"";
  plot.errorUnit = "relative";
  plot.truth = "known";
  plot.samples = {{"slow, plain", {{"n", "1"}}, 1e-2, 2.0, 0},
                  {"slow, plain", {{"n", "2"}}, 1e-4, 4.0, 0},
                  {"fast", {{"tolerance", "1e-3"}}, 1e-3, 0.5, 0},
                  {"exact", {}, 0, 8.0, 0}};
  return plot;
}

TEST(Bench, RatiosAreToTheBaseline) {
  BenchPlot plot = samplePlot();
  plot.rateAgainst("slow, plain", {{"n", "2"}});
  EXPECT_EQ(plot.samples[0].ratio, 0.5);
  EXPECT_EQ(plot.samples[1].ratio, 1);
  EXPECT_EQ(plot.samples[2].ratio, 0.125);
  BenchPlot other = samplePlot();
  other.rateAgainst("nobody", {});
  EXPECT_EQ(other.samples[1].ratio, 0);
}

TEST(Bench, CsvKeepsEveryNumberAndQuotes) {
  const std::string csv = benchCsv(samplePlot());
  EXPECT_EQ(
      csv,
      "method,n,tolerance,error,seconds,ratio\n"
      "\"slow, plain\",1,,0.01,2,0\n\"slow, plain\",2,,1e-04,4,0\nfast,,1e-3,0.001,0.5,0\nexact,,,0,8,0\n");
}

TEST(Bench, SvgShowsEverySampleInsideTheFrame) {
  const std::string svg = benchSvg(samplePlot());
  EXPECT_EQ(count(svg, "<title>"), 4u);
  EXPECT_NE(svg.find("a &lt; b &amp; &quot;c&quot;"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
  EXPECT_NE(svg.find("viewBox=\"0 0 760.0"), std::string::npos);
  BenchPlot wordy = samplePlot();
  for (BenchSample& s : wordy.samples) s.method = std::string(60, 'w');
  EXPECT_NE(benchSvg(wordy).find("viewBox=\"0 0 1048.0"),
            std::string::npos);  // 598 + 60 · 7.5: the legend is whole
  for (std::size_t at = svg.find("<circle cx=\""); at != std::string::npos;
       at = svg.find("<circle cx=\"", at + 1)) {
    const double x = std::stod(svg.substr(at + 12));
    EXPECT_GE(x, 0);
    EXPECT_LE(x, 760);
  }
  BenchPlot empty;
  EXPECT_NE(benchSvg(empty).find("</svg>"), std::string::npos);
  BenchPlot broken = samplePlot();
  broken.samples[0].error = std::nan("");
  EXPECT_EQ(count(benchSvg(broken), "<title>"), 3u);
}

TEST(Bench, BarsHoldOrFail) {
  EXPECT_TRUE((BenchFigure{"a", 1, "", Bar::AtMost, 1}).holds());
  EXPECT_FALSE((BenchFigure{"a", 1.1, "", Bar::AtMost, 1}).holds());
  EXPECT_FALSE((BenchFigure{"a", 1, "", Bar::AtLeast, 2}).holds());
  EXPECT_FALSE((BenchFigure{"a", std::nan(""), ""}).holds());
}

TEST(Bench, UnknownNamesAreRefusedWithTheKnownOnes) {
  const auto result = runBench("hairdryer");
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::NotFound);
  EXPECT_NE(result.error().message.find("place"), std::string::npos);
  EXPECT_FALSE(runBenches("hairdryer").ok());
}

TEST(Bench, CancelledIsAnError) {
  std::atomic<bool> stop{true};
  BenchOptions options;
  options.quick = true;
  options.context.cancel = &stop;
  EXPECT_EQ(runBench("place", options).error().code, ErrorCode::Cancelled);
}

TEST(Bench, PlaceRunsQuicklyAndIsWritten) {
  BenchOptions options;
  options.quick = true;
  const auto reports = runBenches("place", options);
  ASSERT_TRUE(reports.ok()) << reports.error().text();
  const BenchReport& report = reports->front();
  EXPECT_EQ(report.plots.size(), 3u);
  for (const BenchFigure& figure : report.figures) {
    if (figure.name.find("time") == std::string::npos) {  // times depend on what else the machine does
      EXPECT_TRUE(figure.holds()) << figure.name << ' ' << figure.value;
    }
  }
  const auto folder = std::filesystem::path(testing::TempDir()) / "coif_bench_test";
  std::filesystem::remove_all(folder);
  ASSERT_TRUE(writeBench(*reports, folder).ok());
  for (const BenchPlot& plot : report.plots) {
    EXPECT_EQ(count(contents(folder / (plot.name + ".csv")), "\n"), plot.samples.size() + 1);
    EXPECT_EQ(contents(folder / (plot.name + ".svg")), benchSvg(plot));
  }
  const std::string html = contents(folder / "report.html");
  EXPECT_EQ(count(html, "<svg"), report.plots.size());
  EXPECT_NE(html.find("Seed 1"), std::string::npos);
  const auto json = nlohmann::json::parse(contents(folder / "report.json"));
  EXPECT_EQ(json["benches"][0]["name"], "place");
  EXPECT_EQ(json["benches"][0]["figures"].size(), report.figures.size());
  EXPECT_FALSE(json["machine"]["compiler"].get<std::string>().empty());
  std::filesystem::remove_all(folder);
  std::ofstream(folder) << "a file in the way";
  EXPECT_EQ(writeBench(*reports, folder).error().code, ErrorCode::Unreadable);
  std::filesystem::remove(folder);
}

}  // namespace
}  // namespace coif
