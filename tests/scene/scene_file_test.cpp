#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "coif/base/random.h"
#include "coif/hairmesh/operations.h"
#include "coif/scene/scene.h"
#include "scene/sample_scene.h"
#include "scene/typed_array.h"

namespace coif {
namespace {

using nlohmann::json;

TEST(TypedArray, RoundTripsEveryWidthExactly) {
  for (const std::vector<std::uint32_t>& values :
       {std::vector<std::uint32_t>{}, {0}, {255, 0, 7}, {256, 65535}, {65536, 4294967295u, 1, 2}}) {
    EXPECT_EQ(scene::decodeIntegers(scene::encodeIntegers(values)), values);
  }
  const std::vector<double> doubles = {0, -0.0, 1e-310, 0.1, -1e300, 3};
  EXPECT_EQ(scene::decodeDoubles(scene::encodeDoubles(doubles)), doubles);
  EXPECT_FALSE(scene::decodeIntegers("u8:A?=="));
  EXPECT_FALSE(scene::decodeIntegers("f64:"));
  EXPECT_FALSE(scene::decodeDoubles("f64:AAAA"));
}

TEST(SceneFile, RoundTripIsExact) {
  Scene scene = test::sampleScene();
  scene.strands.count = 12345;
  scene.strands.tolerance = 0.25;
  scene.strands.knots = Knots::Chordal;
  scene.look.azimuthDeg = -12.5;
  scene.look.longitudinalRoughness = 0.15, scene.look.azimuthalRoughness = 0.7;
  scene.look.light = {12, -34, 0.5, 2, 0, 3.25, false};
  scene.placedHash = 0xfedcba9876543210ULL;
  const auto again = parseScene(sceneText(scene), "sample.coif");
  ASSERT_TRUE(again.ok()) << again.error().text();
  EXPECT_EQ(again->hairMesh, scene.hairMesh);
  EXPECT_EQ(again->strands, scene.strands);
  EXPECT_EQ(again->look, scene.look);
  EXPECT_EQ(again->placedHash, scene.placedHash);
  EXPECT_EQ(sceneText(*again), sceneText(scene));
}

TEST(SceneFile, HeadPathFollowsTheFile) {
  const auto folder = std::filesystem::temp_directory_path() / "coif-scene-path-test";
  std::filesystem::create_directories(folder / "scenes");
  Scene scene = test::sampleScene();
  scene.head.path = folder / "heads" / "head.obj";
  ASSERT_TRUE(saveScene(scene, folder / "scenes" / "a.coif").ok());
  const auto again = loadScene(folder / "scenes" / "a.coif");
  ASSERT_TRUE(again.ok()) << again.error().text();
  EXPECT_EQ(again->head.path, std::filesystem::path("../heads/head.obj"));
  EXPECT_EQ(std::filesystem::weakly_canonical(again->headPath()),
            std::filesystem::weakly_canonical(folder / "heads" / "head.obj"));
  std::filesystem::remove_all(folder);
}

TEST(SceneFile, HeadPathStartsFromTheFileBehindALink) {
  const auto folder = std::filesystem::temp_directory_path() / "coif-scene-link-test";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder / "scenes");
  Scene scene = test::sampleScene();
  scene.head.path = folder / "head.obj";
  ASSERT_TRUE(saveScene(scene, folder / "scenes" / "a.coif").ok());
  std::filesystem::create_symlink("scenes/a.coif", folder / "link.coif");
  const auto head = std::filesystem::weakly_canonical(folder / "head.obj");
  auto linked = loadScene(folder / "link.coif");
  ASSERT_TRUE(linked.ok()) << linked.error().text();
  EXPECT_EQ(std::filesystem::weakly_canonical(linked->headPath()), head);
  ASSERT_TRUE(saveScene(*linked, folder / "link.coif").ok());  // written through the link
  for (const char* name : {"link.coif", "scenes/a.coif"}) {
    const auto again = loadScene(folder / name);
    ASSERT_TRUE(again.ok()) << again.error().text();
    EXPECT_EQ(std::filesystem::weakly_canonical(again->headPath()), head) << name;
  }
  std::filesystem::remove_all(folder);
}

TEST(SceneFile, WhatCouldNotBeOpenedReplacesNoFile) {
  const auto path = std::filesystem::temp_directory_path() / "coif-scene-spoilt-test.coif";
  const Scene good = test::sampleScene();
  const std::pair<const char*, void (*)(Scene&)> faults[] = {
      {"metersPerUnit", [](Scene& s) { s.metersPerUnit = std::nan(""); }},
      {"strands.points", [](Scene& s) { s.strands.points = 1; }},
      {"strands.width", [](Scene& s) { s.strands.width = -1; }},
      {"dynamics.cell", [](Scene& s) { s.dynamics.cell = 0; }},
      {"look.light.key", [](Scene& s) { s.look.light.key = HUGE_VAL; }}};
  for (const auto& [place, spoil] : faults) {
    Scene scene = good;
    ASSERT_TRUE(saveScene(scene, path).ok());
    spoil(scene);
    const Status status = saveScene(scene, path);
    ASSERT_FALSE(status.ok()) << place;
    EXPECT_EQ(status.error().place, place);
    EXPECT_TRUE(loadScene(path).ok()) << place;
  }
  std::filesystem::remove(path);
}

TEST(SceneFile, RefusesAHeadThatTextCannotName) {
  const auto path = std::filesystem::temp_directory_path() / "coif-scene-utf8-test.coif";
  Scene scene = test::sampleScene();
  scene.head.path = "/heads/\xe9.obj";
  const Status status = saveScene(scene, path);
  ASSERT_FALSE(status.ok());
  EXPECT_NE(status.error().text().find("not UTF-8"), std::string::npos) << status.error().text();
  EXPECT_FALSE(std::filesystem::exists(path));
}

/// Sets one entry of the sample scene and expects a refusal that names `place`.
void expectRefused(const std::function<void(json&)>& spoil, const std::string& place,
                   ErrorCode code = ErrorCode::Malformed) {
  json document = json::parse(sceneText(test::sampleScene()));
  spoil(document);
  const auto result = parseScene(document.dump(), "spoilt.coif");
  ASSERT_FALSE(result.ok()) << place;
  EXPECT_EQ(result.error().code, code) << result.error().text();
  EXPECT_EQ(result.error().file, "spoilt.coif");
  EXPECT_NE(result.error().text().find(place), std::string::npos) << result.error().text();
}

TEST(SceneFile, RefusesWhatBreaksTheFormat) {
  expectRefused([](json& d) { d.erase("format"); }, "format");
  expectRefused([](json& d) { d["version"] = "one"; }, "version");
  expectRefused([](json& d) { d["version"] = 0; }, "version");
  expectRefused([](json& d) { d["version"] = 999; }, "version", ErrorCode::Unsupported);
  expectRefused([](json& d) { d["head"] = 5; }, "head");
  expectRefused([](json& d) { d["head"].erase("path"); }, "head.path");
  expectRefused([](json& d) { d["metersPerUnit"] = -1; }, "metersPerUnit");
  expectRefused([](json& d) { d["upAxis"] = "X"; }, "upAxis");
  expectRefused([](json& d) { d["strands"]["points"] = 1; }, "strands.points");
  expectRefused([](json& d) { d["strands"]["count"] = -3; }, "strands.count");
  expectRefused([](json& d) { d["strands"]["knots"] = "square"; }, "strands.knots");
  expectRefused([](json& d) { d["look"]["hairColor"] = {0, 0, 2}; }, "look.hairColor");
  expectRefused([](json& d) { d["look"]["light"]["rim"] = -1; }, "look.light.rim");
  expectRefused([](json& d) { d.erase("hairMesh"); }, "hairMesh");
  expectRefused([](json& d) { d["hairMesh"]["groupNames"] = {1, 2}; }, "hairMesh.groupNames");
}

TEST(SceneFile, RefusesWhatBreaksTheHairMesh) {
  const auto integers = [](const std::vector<std::uint32_t>& values) {
    return scene::encodeIntegers(values);
  };
  expectRefused([](json& d) { d["hairMesh"]["vertices"]["positions"] = "f64:AAAA"; },
                "hairMesh.vertices.positions");
  expectRefused(
      [](json& d) {
        d["hairMesh"]["vertices"]["positions"] = {1, 2, 3};
      },
      "hairMesh.vertices.positions");
  expectRefused([&](json& d) { d["hairMesh"]["vertices"]["pinned"] = integers({100000}); },
                "hairMesh.vertices.pinned");
  expectRefused([&](json& d) { d["hairMesh"]["splits"] = integers({1, 2}); }, "hairMesh.splits");
  expectRefused([&](json& d) { d["hairMesh"]["bundles"]["heights"] = integers({4294967295u}); },
                "hairMesh.bundles");
  const Scene sample = test::sampleScene();
  const auto spoilVertices = [&](const std::function<void(std::vector<std::uint32_t>&)>& spoil) {
    return [&sample, &integers, spoil](json& d) {
      std::vector<std::uint32_t> values;
      for (const Bundle& bundle : sample.hairMesh.bundles()) {
        values.insert(values.end(), bundle.vertices.begin(), bundle.vertices.end());
      }
      spoil(values);
      d["hairMesh"]["bundles"]["vertices"] = integers(values);
    };
  };
  expectRefused(spoilVertices([](auto& v) { v[3] = 1u << 30; }), "hairMesh.bundles.vertices");
  expectRefused(spoilVertices([](auto& v) { v.pop_back(); }), "hairMesh.bundles.vertices");
  expectRefused(spoilVertices([](auto& v) { v.push_back(0); }), "hairMesh.bundles.vertices");
  // A vertex above itself: a cycle of parents.
  expectRefused(spoilVertices([](auto& v) { v[4] = v[0]; }), "hairMesh");
  std::vector<double> positions(3 * sample.hairMesh.vertices().size(), 1.0);
  positions[7] = std::numeric_limits<double>::quiet_NaN();
  expectRefused([&](json& d) { d["hairMesh"]["vertices"]["positions"] = scene::encodeDoubles(positions); },
                "hairMesh.vertices.positions");
}

TEST(SceneFile, TruncatedAndFlippedBytesNeverCrash) {
  const std::string text = sceneText(test::sampleScene());
  // Up to the closing bracket: without the last line's end the file is still whole.
  for (std::size_t length = 0; length + 2 < text.size(); length += 1 + text.size() / 400) {
    EXPECT_FALSE(parseScene(std::string_view(text).substr(0, length), "cut.coif").ok()) << length;
  }
  const CounterRandom random(11);
  for (std::uint64_t i = 0; i < 2000; ++i) {
    std::string spoilt = text;
    spoilt[random.below(2 * i, std::uint32_t(text.size()))] = char(random.bits(2 * i + 1));
    const auto result = parseScene(spoilt, "flipped.coif");
    if (result.ok()) {
      for (const HairVertex& vertex : result->hairMesh.vertices()) ASSERT_TRUE(vertex.position.allFinite());
    }
  }
}

TEST(SceneFile, DeepNestingIsRefusedWithoutRecursion) {
  const auto result = parseScene("{\"format\":" + std::string(100000, '['), "deep.coif");
  ASSERT_FALSE(result.ok());
  EXPECT_NE(result.error().text().find("nested"), std::string::npos);
}

TEST(SceneFile, VersionOneStillOpens) {
  // A file as the first release wrote it; it must open for ever.
  const auto scene = loadScene(std::filesystem::path(COIF_SOURCE_DIR) / "tests/scene/files/version_1.coif");
  ASSERT_TRUE(scene.ok()) << scene.error().text();
  EXPECT_EQ(scene->hairMesh.bundles().size(), 4u);
  EXPECT_EQ(scene->name, "sample");
}

}  // namespace
}  // namespace coif
