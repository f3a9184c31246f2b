// Dynamics in the document, the stage "simulate", and the cache file.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "coif/io/mesh_io.h"
#include "coif/io/safe_file.h"
#include "coif/scene/dynamics_text.h"
#include "coif/scene/evaluate.h"
#include "scene/sample_scene.h"

namespace coif {
namespace {

using nlohmann::json;

std::filesystem::path folder() {
  const auto path = std::filesystem::temp_directory_path() / "coif-dynamics-test";
  std::filesystem::create_directories(path);
  return path;
}

EvaluateOptions noHead() {
  EvaluateOptions options;
  options.useHead = false;
  return options;
}

SimulateOptions frames(std::size_t count) {
  SimulateOptions what;
  what.frames = count;
  return what;
}

DynamicsSettings unlikeTheDefaults() {
  DynamicsSettings s;
  s.method = DynamicsMethod::EnergyKeeping;
  double* numbers[] = {&s.longestStep, &s.settleSeconds,    &s.gravity,    &s.droop,       &s.lateral,
                       &s.drag,        &s.gustSpeed,        &s.gustSize,   &s.gustSeconds, &s.shelter,
                       &s.thickness,   &s.contactStiffness, &s.friction,   &s.repulsion,   &s.density,
                       &s.cell,        &s.hairFriction,     &s.sleepSpeed, &s.sleepSeconds};
  double value = 0.1234567890123;
  for (double* number : numbers) *number = value += 0.01;
  s.tolerance = 0.0123456789;
  s.singlePrecision = true;
  s.skipBending = false;
  s.wisps = 57;
  s.guidePoints = 9;
  s.wind = WindKind::Gusts;
  s.windVelocity = Vec3(1, -2, 0.3);
  s.seed = ~std::uint64_t{0};
  s.airCells = 17;
  s.collide = false;
  s.capsules.push_back({Vec3(1, 2, 3), Vec3(4, 5, 6), 0.7, false});
  return s;
}

TEST(DynamicsSettings, SurviveTheFileToTheBit) {
  Scene scene = test::sampleScene();
  scene.dynamics = unlikeTheDefaults();
  const auto again = parseScene(sceneText(scene), "a.coif");
  ASSERT_TRUE(again.ok()) << again.error().text();
  EXPECT_EQ(again->dynamics, scene.dynamics);
  EXPECT_EQ(sceneText(*again), sceneText(scene));
}

TEST(DynamicsSettings, AreDefaultsInAnOlderFile) {
  json document = json::parse(sceneText(test::sampleScene()));
  document["version"] = 1;
  document.erase("dynamics");
  const auto scene = parseScene(document.dump(), "old.coif");
  ASSERT_TRUE(scene.ok()) << scene.error().text();
  EXPECT_EQ(scene->dynamics, DynamicsSettings{});
}

// A file of before there were wisps, sleep and a choice of precision.
TEST(DynamicsSettings, NewOnesAreDefaultsInAnOlderFile) {
  Scene scene = test::sampleScene();
  scene.dynamics.droop = 0.7;
  json document = json::parse(sceneText(scene));
  for (const char* key :
       {"wisps", "guidePoints", "tolerance", "sleepSpeed", "sleepSeconds", "precision", "skipBending"})
    EXPECT_EQ(document["dynamics"].erase(key), 1u) << key;
  const auto again = parseScene(document.dump(), "old.coif");
  ASSERT_TRUE(again.ok()) << again.error().text();
  EXPECT_EQ(again->dynamics, scene.dynamics);
}

TEST(DynamicsSettings, AreSetByNameAndRefusedWithASentence) {
  const DynamicsSettings wanted = unlikeTheDefaults();
  Scene scene = test::sampleScene();
  scene.dynamics = wanted;
  const json all = json::parse(sceneText(scene))["dynamics"];
  DynamicsSettings s;
  s.capsules = wanted.capsules;
  for (const std::string& name : dynamicsNames()) {
    const json& value = all[name];
    const std::string text = name == "windVelocity" ? "1,-2,0.3"
                             : value.is_string()    ? value.get<std::string>()
                                                    : value.dump();
    EXPECT_TRUE(setDynamics(s, name, text).ok()) << name << " " << text;
  }
  EXPECT_EQ(s, wanted);
  for (const auto& [name, value] :
       std::vector<std::pair<std::string, std::string>>{{"drop", "1"},
                                                        {"capsules", ""},
                                                        {"droop", "much"},
                                                        {"droop", "-1"},
                                                        {"droop", ""},
                                                        {"solver", "fast"},
                                                        {"windVelocity", "1,2"},
                                                        {"windVelocity", "1,2,3,4"},
                                                        {"collide", "2"},
                                                        {"wisps", "1e9"},
                                                        {"wisps", "[]"}}) {
    const Status refused = setDynamics(s, name, value);
    ASSERT_FALSE(refused.ok()) << name << " " << value;
    EXPECT_EQ(refused.error().code, ErrorCode::InvalidArgument);
    EXPECT_NE(refused.error().text().find(name), std::string::npos) << refused.error().text();
  }
  EXPECT_EQ(s, wanted);
}

TEST(DynamicsSettings, EveryBadValueIsRefusedByName) {
  const json good = json::parse(sceneText(test::sampleScene()));
  int tried = 0;
  for (const auto& [key, value] : good["dynamics"].items()) {
    for (const json& bad : {json("nonsense"), json(-1e20), json(json::array()), json(nullptr)}) {
      json document = good;
      document["dynamics"][key] = bad;
      const auto scene = parseScene(document.dump(), "bad.coif");
      ASSERT_FALSE(scene.ok()) << key << " " << bad;
      EXPECT_EQ(scene.error().code, ErrorCode::Malformed);
      EXPECT_NE(scene.error().place.find("dynamics." + key), std::string::npos) << scene.error().text();
      ++tried;
    }
  }
  EXPECT_GT(tried, 80);
}

TEST(SimulateStage, RunsOnceIsReusedAndGoesOn) {
  const Scene scene = test::sampleScene();
  Evaluation evaluation(noHead());
  const auto first = evaluation.simulate(scene, frames(5));
  ASSERT_TRUE(first.ok()) << first.error().text();
  EXPECT_EQ((*first)->frameCount(), 5u);
  // Frame 0 is the placed mesh, in floats.
  const HairMesh placed = **evaluation.placedMesh(scene);
  for (std::size_t v = 0; v < placed.vertices().size(); ++v)
    EXPECT_EQ((*first)->frame(0)[v], placed.vertices()[v].position.cast<float>());
  evaluation.clearReports();
  ASSERT_TRUE(evaluation.simulate(scene, frames(4)).ok());
  EXPECT_EQ(evaluation.reports().back().state, StageState::Reused);
  const auto longer = evaluation.simulate(scene, frames(8));
  ASSERT_TRUE(longer.ok());
  EXPECT_EQ(evaluation.simulationReport()->frames, 3u);  // three more, not eight
  Evaluation fresh(noHead());
  EXPECT_EQ(cacheBytes(**fresh.simulate(scene, frames(8))), cacheBytes(**longer));
  Scene other = scene;
  other.dynamics.drag += 1;
  evaluation.clearReports();
  ASSERT_TRUE(evaluation.simulate(other, frames(4)).ok());
  EXPECT_EQ(evaluation.reports().back().state, StageState::Ran);
}

TEST(SimulateStage, ResumesFromAFileWithTheSameBytes) {
  const Scene scene = test::sampleScene();
  SimulateOptions what = frames(6);
  what.cache = folder() / "whole.coifcache";
  std::filesystem::remove(what.cache);
  ASSERT_TRUE(Evaluation(noHead()).simulate(scene, what).ok());
  SimulateOptions part = frames(3);
  part.cache = folder() / "part.coifcache";
  std::filesystem::remove(part.cache);
  ASSERT_TRUE(Evaluation(noHead()).simulate(scene, part).ok());
  part.frames = 6;
  Evaluation second(noHead());
  ASSERT_TRUE(second.simulate(scene, part).ok());
  EXPECT_EQ(second.simulationReport()->frames, 3u);
  EXPECT_EQ(readFile(what.cache).value(), readFile(part.cache).value());
  Scene other = scene;
  other.dynamics.gravity = 1;
  const auto refused = Evaluation(noHead()).simulate(other, part);
  ASSERT_FALSE(refused.ok());  // and the file is as it was
  EXPECT_EQ(readFile(what.cache).value(), readFile(part.cache).value());
}

// Stopped in the middle: what is done is in the file, and going on gives the bytes of a run that was left
// alone.
TEST(SimulateStage, AnInterruptedRunGoesOnWithTheSameBytes) {
  const Scene scene = test::sampleScene();
  SimulateOptions what = frames(9);
  what.cache = folder() / "alone.coifcache";
  std::filesystem::remove(what.cache);
  ASSERT_TRUE(Evaluation(noHead()).simulate(scene, what).ok());
  SimulateOptions cut = frames(9);
  cut.cache = folder() / "cut.coifcache";
  std::filesystem::remove(cut.cache);
  std::atomic<bool> cancel = false;
  Context context;
  context.cancel = &cancel;
  context.progress = [&](std::string_view stage, double fraction) {
    if (stage == "simulating" && fraction > 0.4) cancel = true;
  };
  const auto stopped = Evaluation(noHead()).simulate(scene, cut, context);
  ASSERT_FALSE(stopped.ok());
  EXPECT_EQ(stopped.error().code, ErrorCode::Cancelled);
  const std::size_t kept = loadCache(cut.cache).value().frameCount();
  EXPECT_GT(kept, 1u);
  EXPECT_LT(kept, 9u);
  ASSERT_TRUE(Evaluation(noHead()).simulate(scene, cut).ok());
  EXPECT_EQ(readFile(what.cache).value(), readFile(cut.cache).value());
}

TEST(SimulateStage, StrandsOfAFrameAreThoseOfTheSceneAndTurnWithTheHead) {
  Scene scene = test::sampleScene();
  scene.strands.count = 50;
  scene.dynamics.gravity = 0;
  Evaluation evaluation(noHead());
  SimulateOptions what = frames(2);
  const Mat3 turn = Eigen::AngleAxisd(1, Vec3(0, 1, 0)).toRotationMatrix();
  what.motion.poses = {{turn, Vec3(3, 0, 0)}};
  const auto motion = evaluation.simulate(scene, what);
  ASSERT_TRUE(motion.ok()) << motion.error().text();
  const auto posed = evaluation.strandsAt(scene, **motion, 0);
  ASSERT_TRUE(posed.ok()) << posed.error().text();
  const StrandSet rest = **evaluation.strands(scene);
  EXPECT_EQ(posed->offsets, rest.offsets);
  EXPECT_EQ(posed->ids, rest.ids);
  for (std::size_t p = 0; p < rest.points.size(); ++p) {
    const Vec3 expected = turn * rest.points[p].cast<double>() + Vec3(3, 0, 0);
    // Frames are floats: a few units of 1e-7 of the size, through the spline's weights.
    EXPECT_LE((posed->points[p].cast<double>() - expected).norm(), 1e-5 * (1 + expected.norm()));
  }
  EXPECT_FALSE(evaluation.strandsAt(scene, **motion, 2).ok());
}

TEST(SimulateStage, WritesUsdTimeSamplesAndDrapes) {
  Scene scene = test::sampleScene();
  scene.strands.count = 20;
  Evaluation evaluation(noHead());
  const auto path = folder() / "motion.usda";
  const auto written = evaluation.exportMotion(scene, frames(3), path);
  ASSERT_TRUE(written.ok()) << written.error().text();
  std::ifstream file(path);
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  EXPECT_NE(text.find("points.timeSamples"), std::string::npos);
  const HairMesh before = scene.hairMesh;
  const auto draped = evaluation.drape(scene);
  ASSERT_TRUE(draped.ok()) << draped.error().text();
  EXPECT_GT(draped->greatestMove, 0);
  EXPECT_FALSE(scene.hairMesh == before);
  EXPECT_EQ(scene.placedHash, meshHash(scene.hairMesh));
}

// The head goes along: its transform at a frame takes its rest to where the roots of that frame are.
TEST(SimulateStage, WritesAMovingHeadAsTimeSamplesOfItsTransform) {
  const auto head = folder() / "head.obj";
  std::ofstream(head) << "v -9 0 -9\nv -9 0 9\nv 9 0 9\nv 9 0 -9\nf 1 2 3 4\n";
  Scene scene = test::sampleScene();
  scene.strands.count = 20;
  scene.dynamics.collide = false;  // a plane has no inside
  scene.head.path = head;
  scene.head.contentHash = fileHash(head).value();
  Evaluation evaluation;
  SimulateOptions what = frames(3);
  for (int f = 0; f < 3; ++f) {
    what.motion.poses.push_back(
        {Eigen::AngleAxisd(0.5 * f, Vec3::UnitY()).toRotationMatrix(), Vec3(0.25 * f, 0, 0)});
  }
  for (const char* name : {"moving.usda", "moving.usdc"}) {
    const auto path = folder() / name;
    const auto written = evaluation.exportMotion(scene, what, path);
    ASSERT_TRUE(written.ok()) << written.error().text();
    EXPECT_TRUE(loadPolygonMesh(path).ok());
  }
  std::ifstream file(folder() / "moving.usda");
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  const std::size_t at = text.find("xformOp:transform.timeSamples");
  ASSERT_NE(at, std::string::npos);
  // The last sample's translation: a row of its own, USD's points being rows.
  EXPECT_NE(text.find("(0.5, 0, 0, 1)", at), std::string::npos) << text.substr(at, 600);
}

// What was left out is named with its switch, its trigger and how much it was; each switch brings it back.
TEST(SimulateStage, NamesWhatItLeftOut) {
  Scene scene = test::sampleScene();
  scene.dynamics.droop = 0;
  scene.dynamics.drag = 20;
  const auto leftOut = [&] {
    Evaluation evaluation(noHead());
    EXPECT_TRUE(evaluation.simulate(scene, frames(100)).ok());
    const StageReport report = evaluation.reports().back();
    const json parsed = json::parse(reportJson(evaluation.reports()))["stages"].back();
    EXPECT_EQ(parsed["leftOut"].size(), report.leftOut.size());
    std::map<std::string, double> shares;
    for (const LeftOut& part : report.leftOut) {
      shares[part.control] = part.share;
      EXPECT_GT(part.share, 0) << part.what;
      EXPECT_LE(part.share, 1) << part.what;
      EXPECT_NE(
          explainText(evaluation.reports()).find(part.what + " (" + part.control + "): " + part.trigger),
          std::string::npos);
    }
    return shares;
  };
  auto shares = leftOut();
  EXPECT_GT(shares["sleepSpeed"], 0.1);  // hair hangs still after a second or two of four
  EXPECT_EQ(shares["skipBending"], 1);
  EXPECT_GT(shares["tolerance"], 0.99);
  EXPECT_EQ(shares["repulsion"], 1);
  EXPECT_EQ(shares["collide"], 1);
  EXPECT_EQ(shares["wind"], 1);
  EXPECT_FALSE(shares.contains("precision"));
  scene.dynamics.sleepSpeed = 0;
  scene.dynamics.skipBending = false;
  scene.dynamics.singlePrecision = true;
  scene.dynamics.repulsion = scene.dynamics.density = 1;
  scene.dynamics.wind = WindKind::Constant;
  scene.dynamics.capsules.push_back({Vec3(0, 500, 0), Vec3(0, 500, 0), 1, true});  // far away
  shares = leftOut();
  EXPECT_FALSE(shares.contains("sleepSpeed"));
  EXPECT_FALSE(shares.contains("skipBending"));
  EXPECT_FALSE(shares.contains("wind"));
  EXPECT_EQ(shares["precision"], 1);
  EXPECT_EQ(shares["collide"], 1);  // there is something to collide with, and nothing reaches it
}

// Guides of wisps through the document: frame 0 is the modelled style, a turned head turns every strand.
TEST(SimulateStage, WispsCarryTheStrandsOfAFrame) {
  Scene scene = test::sampleScene();
  scene.strands.count = 80;
  scene.dynamics.gravity = 0;
  scene.dynamics.wisps = 6;
  scene.dynamics.guidePoints = 7;
  Evaluation evaluation(noHead());
  SimulateOptions what = frames(3);
  const Mat3 turn = Eigen::AngleAxisd(1, Vec3(0, 1, 0)).toRotationMatrix();
  what.motion.poses = {{turn, Vec3(3, 0, 0)}};
  what.cache = folder() / "wisps.coifcache";
  std::filesystem::remove(what.cache);
  const auto motion = evaluation.simulate(scene, what);
  ASSERT_TRUE(motion.ok()) << motion.error().text();
  EXPECT_EQ((*motion)->vertexCount, *evaluation.movedPoints(scene));
  EXPECT_LE((*motion)->vertexCount, 6u * 3 * 7);
  const StrandSet rest = **evaluation.strands(scene);
  for (const std::size_t frame : {0, 2}) {
    const auto posed = evaluation.strandsAt(scene, **motion, frame);
    ASSERT_TRUE(posed.ok()) << posed.error().text();
    EXPECT_EQ(posed->ids, rest.ids);
    for (std::size_t p = 0; p < rest.points.size(); ++p) {
      const Vec3 expected = turn * rest.points[p].cast<double>() + Vec3(3, 0, 0);
      // Guides are floats: a few units of 1e-7 of the size.
      ASSERT_LE((posed->points[p].cast<double>() - expected).norm(), 1e-5 * (1 + expected.norm())) << p;
    }
  }
  EXPECT_FALSE(evaluation.meshAt(scene, **motion, 0).ok());  // with a sentence: wisps move no mesh
  const auto written = evaluation.exportMotion(scene, what, folder() / "wisps.usda");
  ASSERT_TRUE(written.ok()) << written.error().text();
  // A file of it is gone on with by another evaluation.
  Evaluation second(noHead());
  what.frames = 5;
  const auto longer = second.simulate(scene, what);
  ASSERT_TRUE(longer.ok());
  EXPECT_EQ(second.simulationReport()->frames, 2u);
  scene.dynamics.wisps = 0;
  EXPECT_FALSE(second.strandsAt(scene, **longer, 0).ok());  // of another scene
}

TEST(Cache, RoundTripsAndRefusesEveryCutAndEveryChangedByte) {
  DynamicsCache cache;
  cache.key = 42;
  cache.framesPerSecond = 30;
  cache.vertexCount = 2;
  cache.poses.resize(3);
  for (int i = 0; i < 6; ++i) cache.positions.push_back(Vec3f(float(i), 1, 2));
  cache.state.resize(11, std::byte{7});
  const auto bytes = cacheBytes(cache);
  const auto again = parseCache(bytes);
  ASSERT_TRUE(again.ok()) << again.error().text();
  EXPECT_EQ(cacheBytes(*again), bytes);
  for (std::size_t length = 0; length < bytes.size(); ++length)
    EXPECT_FALSE(parseCache(std::span(bytes).first(length)).ok()) << length;
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    auto changed = bytes;
    changed[at] ^= std::byte{0x40};
    EXPECT_FALSE(parseCache(changed).ok()) << at;
  }
  EXPECT_EQ(loadCache(folder() / "none.coifcache").error().code, ErrorCode::NotFound);
}

}  // namespace
}  // namespace coif
