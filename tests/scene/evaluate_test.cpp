#include "coif/scene/evaluate.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "scene/sample_scene.h"

namespace coif {
namespace {

EvaluateOptions withoutHead() {
  EvaluateOptions options;
  options.useHead = false;
  return options;
}

/// State of the last report of a stage since the reports were cleared.
StageState lastState(const Evaluation& evaluation, const std::string& stage) {
  const StageReport* found = nullptr;
  for (const StageReport& report : evaluation.reports()) {
    if (report.name == stage) found = &report;
  }
  if (!found) throw std::runtime_error("no report of " + stage);
  return found->state;
}

TEST(Evaluation, RunsOnlyWhatItsInputsChanged) {
  Scene scene = test::sampleScene();
  scene.strands.count = 100;
  Evaluation evaluation(withoutHead());
  ASSERT_TRUE(evaluation.strands(scene).ok());
  EXPECT_EQ(lastState(evaluation, "head"), StageState::Skipped);
  EXPECT_EQ(lastState(evaluation, "place"), StageState::Ran);
  EXPECT_EQ(lastState(evaluation, "strands"), StageState::Ran);

  evaluation.clearReports();
  ASSERT_TRUE(evaluation.strands(scene).ok());
  for (const char* stage : {"check", "place", "strands"})
    EXPECT_EQ(lastState(evaluation, stage), StageState::Reused);

  evaluation.clearReports();
  scene.strands.count = 101;
  EXPECT_EQ((*evaluation.strands(scene))->strandCount(), 101u);
  EXPECT_EQ(lastState(evaluation, "place"), StageState::Reused);
  EXPECT_EQ(lastState(evaluation, "strands"), StageState::Ran);

  evaluation.clearReports();
  const std::uint32_t tip = scene.hairMesh.bundles()[0].face(3)[0];
  scene.hairMesh.setPosition(tip, scene.hairMesh.position(tip) + Vec3(0, 0, 1));
  ASSERT_TRUE(evaluation.strands(scene).ok());
  EXPECT_EQ(lastState(evaluation, "place"), StageState::Ran);
  EXPECT_EQ(lastState(evaluation, "strands"), StageState::Ran);
}

TEST(Evaluation, SkippingThePlacementChangesNothing) {
  Scene scene = test::sampleScene();
  scene.strands.count = 64;
  Evaluation first(withoutHead());
  const StrandSet solved = **first.strands(scene);
  scene.hairMesh = **first.placedMesh(scene);
  scene.placedHash = meshHash(scene.hairMesh);

  Evaluation lazy(withoutHead());
  const StrandSet skipped = **lazy.strands(scene);
  EXPECT_EQ(lastState(lazy, "place"), StageState::Skipped);
  EXPECT_EQ(skipped.points.size(), solved.points.size());
  EXPECT_EQ(skipped.points, solved.points);

  EvaluateOptions options = withoutHead();
  options.force = {"place"};
  Evaluation forced(options);
  ASSERT_TRUE(forced.strands(scene).ok());
  EXPECT_EQ(lastState(forced, "place"), StageState::Ran);
}

TEST(Evaluation, AHeadThatChangedIsReadAgainAndSaid) {
  const auto path = std::filesystem::temp_directory_path() / "coif-evaluate-head.obj";
  const auto write = [&](double height) {
    std::ofstream(path) << "v 0 0 " << height << "\nv 2 0 " << height << "\nv 2 2 " << height << "\nv 0 2 "
                        << height << "\nf 1 2 3 4\n";
  };
  write(0);
  Scene scene = test::sampleScene();
  scene.strands.count = 16;
  scene.head.path = path;
  scene.head.contentHash = fileHash(path).value();
  Evaluation evaluation;
  const StrandSet before = **evaluation.strands(scene);
  EXPECT_TRUE(evaluation.reports()[0].notes.size() == 1);
  evaluation.clearReports();
  write(-0.25);
  std::filesystem::last_write_time(path, std::filesystem::last_write_time(path) + std::chrono::seconds(2));
  const StrandSet after = **evaluation.strands(scene);
  EXPECT_EQ(lastState(evaluation, "head"), StageState::Ran);
  EXPECT_EQ(evaluation.reports()[0].notes.size(), 2u);
  // Roots follow the head down by exactly its move.
  EXPECT_NEAR(after.points[0].z() - before.points[0].z(), -0.25, 1e-6);
  std::filesystem::remove(path);
}

TEST(Evaluation, AHeadThatIsGoneIsNamed) {
  Scene scene = test::sampleScene();
  scene.head.path = "/no/such/folder/head.obj";
  Evaluation evaluation;
  const auto strands = evaluation.strands(scene);
  ASSERT_FALSE(strands.ok());
  EXPECT_EQ(strands.error().code, ErrorCode::NotFound);
  EXPECT_NE(strands.error().text().find("/no/such/folder/head.obj"), std::string::npos);
}

TEST(Evaluation, ReportIsJsonWithEveryStage) {
  Scene scene = test::sampleScene();
  scene.strands.count = 10;
  Evaluation evaluation(withoutHead());
  ASSERT_TRUE(evaluation.strands(scene).ok());
  const auto report = nlohmann::json::parse(reportJson(evaluation.reports()));
  ASSERT_EQ(report["stages"].size(), 5u);
  for (const auto& stage : report["stages"]) {
    EXPECT_TRUE(stage.contains("stage") && stage.contains("state") && stage.contains("because"));
    EXPECT_GE(stage["seconds"].get<double>(), 0.0);
  }
  EXPECT_NE(explainText(evaluation.reports()).find("switched off"), std::string::npos);
}

}  // namespace
}  // namespace coif
