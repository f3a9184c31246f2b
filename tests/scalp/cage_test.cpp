#include "coif/scalp/cage.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>

#include "cage_checks.h"
#include "coif/io/mesh_io.h"
#include "coif/scalp/example_head.h"
#include "shapes.h"

namespace coif {
namespace {

using namespace test;

TEST(Cage, OnAHemisphereIsEvenSymmetricAndRound) {
  const PolygonMesh mesh = sphere(4);
  const Surface surface(mesh);
  const auto region = regionOfHalfSpace(mesh, {0, 0.05, 0}, {0, 1, 0});
  for (int count : {2, 16, 50, 200, 1000}) {
    const auto cage = buildCage(mesh, surface, *region, counted(count));
    ASSERT_TRUE(cage.ok()) << cage.error().text();
    checkCage(*cage, surface);
    EXPECT_NEAR(double(cage->faceCount()), count, std::max(4.0, 0.12 * count));
    ASSERT_TRUE(cage->mirror.has_value());
    // A turned icosphere is not triangulated alike on both sides: a sagitta (1e-3) at most.
    EXPECT_LT(cage->quality.mirrorError, 1e-3);
    for (std::size_t v = 0; v < cage->positions.size(); ++v)
      if (cage->boundary[v]) {
        EXPECT_NEAR(cage->positions[v].y(), 0.05, 2e-3);
      }  // snapped by 1 % of an edge
    if (count >= 50) {
      EXPECT_LT(cage->quality.maxAreaRatio, 2.2);
    }
  }
}

TEST(Cage, RowsRunFromFrontToBackAndColumnsFromLeftToRight) {
  const PolygonMesh mesh = makeExampleHead(24);
  const Surface surface(mesh);
  const auto cage = buildCage(mesh, surface, *automaticCap(surface));
  ASSERT_TRUE(cage.ok());
  const HeadFrame& frame = cage->frame;
  EXPECT_NEAR(frame.forward.z(), 1, 1e-9);
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return cage->positions[cage->vertexAt(i, j)]; };
  const std::uint32_t n = cage->columns, m = cage->rows;
  EXPECT_GT((at(n / 2, 0) - at(n / 2, m)).dot(frame.forward), 0.2 * frame.height);
  EXPECT_GT((at(n, m / 2) - at(0, m / 2)).dot(frame.right), 0.2 * frame.height);
  EXPECT_EQ(cage->uv[cage->vertexAt(n / 2, 0)], Vec2(0, -1));
  EXPECT_EQ(cage->uv[cage->vertexAt(n, m)], Vec2(1, 1));
}

TEST(Cage, ExactKeepsTheRegionsOwnPolygons) {
  const PolygonMesh whole = sheet(6, 4);
  for (const PolygonMesh& mesh : {whole, exploded(whole)}) {
    const Surface surface(mesh);
    const auto cage = buildCage(mesh, surface, *regionOfAll(mesh), counted(200, true));
    ASSERT_TRUE(cage.ok()) << cage.error().text();
    EXPECT_EQ(cage->faceCount(), 24u);
    EXPECT_EQ(cage->positions.size(), 35u);
    EXPECT_EQ(cage->uv.size(), 35u);
    EXPECT_EQ(std::count(cage->boundary.begin(), cage->boundary.end(), 1), 20);
    checkOnSurface(*cage, surface);
  }
}

TEST(Cage, ExactTakesTopologiesThatAGridCannot) {
  const PolygonMesh ring = torus(20, 10);
  const Surface surface(ring);
  const auto cage = buildCage(ring, surface, *regionOfAll(ring), counted(200, true));
  ASSERT_TRUE(cage.ok()) << cage.error().text();
  EXPECT_EQ(cage->faceCount(), 200u);
  EXPECT_TRUE(cage->uv.empty());
}

TEST(Cage, RefusesClosedRingHandleAndForeignRegionsWithAReason) {
  const PolygonMesh ball = sphere(3), ring = torus(40, 20);
  const Surface onBall(ball), onRing(ring);
  const auto says = [](const Result<Cage>& cage, const char* word) {
    return !cage.ok() && cage.error().message.find(word) != std::string::npos;
  };
  EXPECT_TRUE(says(buildCage(ball, onBall, *regionOfAll(ball)), "closed"));
  const Region belt = *intersection(*regionOfHalfSpace(ball, {0, -0.3, 0}, {0, 1, 0}),
                                    *regionOfHalfSpace(ball, {0, 0.3, 0}, {0, -1, 0}));
  EXPECT_TRUE(says(buildCage(ball, onBall, belt), "ring"));
  Region handle = *regionOfAll(ring);
  handle.faces[0] = 0;
  EXPECT_FALSE(buildCage(ring, onRing, handle).ok());
  EXPECT_TRUE(says(buildCage(ball, onBall, *regionOfAll(cube())), "belong"));
  EXPECT_FALSE(buildCage(ball, onBall, belt, counted(1)).ok());
  EXPECT_FALSE(buildCage(ball, onBall, belt, counted(2000000)).ok());
}

TEST(Cage, TakesTheLargestPartAndBridgesASmallHole) {
  const PolygonMesh mesh = sphere(4);
  const Surface surface(mesh);
  const Region cap = *regionOfHalfSpace(mesh, {0, 0.2, 0}, {0, 1, 0}),
               spot = *regionOfSphere(mesh, {0, -1, 0}, 0.3);
  const auto parts = buildCage(mesh, surface, *unionOf(cap, spot));
  ASSERT_TRUE(parts.ok()) << parts.error().text();
  checkCage(*parts, surface);
  for (const Vec3& p : parts->positions) EXPECT_GT(p.y(), 0.19);
  EXPECT_NE(parts->notes.back().find("parts"), std::string::npos);

  const Region hole = *difference(cap, *regionOfSphere(mesh, {0, 1, 0}, 0.12));
  const auto bridged = buildCage(mesh, surface, hole);
  ASSERT_TRUE(bridged.ok()) << bridged.error().text();
  checkCage(*bridged, surface);
}

TEST(Cage, SingleFacesAndSteppedRegionsWork) {
  const PolygonMesh mesh =
      sheet(12, 12, [](double x, double y) { return 0.2 * std::sin(3 * x) * std::cos(2 * y); });
  const Surface surface(mesh);
  const std::vector<std::uint32_t> one{40};
  const auto single = buildCage(mesh, surface, *regionOfFaces(mesh, one), counted(20));
  ASSERT_TRUE(single.ok()) << single.error().text();
  checkOnSurface(*single, surface);
  EXPECT_EQ(single->quality.flips, 0u);

  std::vector<std::uint32_t> stepped;
  for (std::uint32_t f = 0; f < mesh.faceCount(); ++f)
    if (std::hypot(f % 12 - 5.5, f / 12 - 5.5) < 4.6) stepped.push_back(f);
  const auto cage = buildCage(mesh, surface, *regionOfFaces(mesh, stepped));
  ASSERT_TRUE(cage.ok()) << cage.error().text();
  checkCage(*cage, surface);
}

TEST(Cage, IsTheSameEveryTimeAndCanBeCancelled) {
  const PolygonMesh mesh = makeExampleHead(16);
  const Surface surface(mesh);
  const Region cap = *automaticCap(surface);
  const auto a = buildCage(mesh, surface, cap), b = buildCage(mesh, surface, cap);
  EXPECT_EQ(a->positions, b->positions);
  std::atomic<bool> stop = true;
  Context context;
  context.cancel = &stop;
  EXPECT_EQ(buildCage(mesh, surface, cap, {}, context).error().code, ErrorCode::Cancelled);
}

/// A copy whose faces name positions alone: one head's faces name texture coordinates that its file lacks.
std::filesystem::path positionsOnly(const std::filesystem::path& path) {
  const auto copy = std::filesystem::path(::testing::TempDir()) / path.filename();
  std::ifstream in(path);
  std::ofstream out(copy);
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("f ")) line = std::regex_replace(line, std::regex("/[0-9/]*"), "");
    if (!line.starts_with("vt ")) out << line << '\n';
  }
  return copy;
}

struct Head {
  const char* file;
  Vec3 forward;
  double chin;             ///< height of the chin, measured on the mesh by eye
  std::vector<Vec3> bare;  ///< places that must stay free: nose, eye or cheek, chin, ears, neck
  std::vector<Vec3> hairy;
};

class Heads : public ::testing::TestWithParam<Head> {};

TEST_P(Heads, GiveARegionAndACage) {
  const Head& head = GetParam();
  PolygonMesh mesh;
  if (std::string_view(head.file) == "example") {
    mesh = makeExampleHead();
  } else {
    const std::filesystem::path path = std::filesystem::path(COIF_SHARED_DATA) / "heads" / head.file;
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
    auto loaded = loadPolygonMesh(positionsOnly(path));
    ASSERT_TRUE(loaded.ok()) << loaded.error().text();
    mesh = std::move(loaded).value();
  }
  const Surface surface(mesh);
  const auto region = automaticCap(surface);
  ASSERT_TRUE(region.ok()) << region.error().text();
  const HeadFrame& frame = *region->frame;
  EXPECT_GT(frame.forward.dot(head.forward), 0.99);
  EXPECT_TRUE(frame.faceFound && frame.earsFound && frame.mirror.accepted);
  double crown = -1e300;
  for (const Vec3& p : mesh.positions)
    if ((p - frame.centre).norm() < 0.7 * frame.depth) crown = std::max(crown, p.y());
  EXPECT_NEAR(frame.height, crown - head.chin, 0.08 * (crown - head.chin));  // stated in head_frame.h
  for (const Vec3& p : head.bare) EXPECT_FALSE(region->faces[surface.nearest(p).face]) << p.transpose();
  for (const Vec3& p : head.hairy) EXPECT_TRUE(region->faces[surface.nearest(p).face]) << p.transpose();

  const auto cage = buildCage(mesh, surface, *region);
  ASSERT_TRUE(cage.ok()) << cage.error().text();
  checkCage(*cage, surface);
  EXPECT_NEAR(double(cage->faceCount()), 200, 10);
  EXPECT_TRUE(cage->mirror.has_value());
  // Scans are not symmetric, and fans of quads are not alike on both sides.
  EXPECT_LT(cage->quality.mirrorError, 0.03);
  EXPECT_LT(cage->quality.maxDistance, 0.02);
  EXPECT_GT(cage->quality.minAreaRatio, 0.1);
  EXPECT_LT(cage->quality.maxAreaRatio, 2.5);
  EXPECT_LT(cage->quality.maxAspect, 4);
}

INSTANTIATE_TEST_SUITE_P(
    Real, Heads,
    ::testing::Values(
        Head{"lee-perry-smith.obj",
             {0, 0, 1},
             -0.45,
             {{-0.08, 1.1, 2.6},
              {0.5, 1.9, 1.9},
              {-0.08, -0.3, 2.3},
              {1.7, 1.3, -0.2},
              {-1.9, 1.3, -0.2},
              {-0.08, -0.2, -1.4}},
             {{-0.08, 4, 0}, {-0.08, 2.2, -2}, {-0.08, 3.5, 1.6}, {1.5, 2.6, -0.3}, {-1.6, 2.6, -0.3}}},
        Head{"tressfx-ponytail-head.obj",
             {0, 0, -1},
             36.5,
             {{0, 62, -36.7}, {10, 80, -29}, {0, 42, -27}, {29, 72, 12}, {-29, 72, 12}, {0, 50, 28}},
             {{0, 119, 0}, {0, 95, 35}, {10, 110, -18}, {24, 95, 8}, {-24, 95, 8}}},
        Head{"suzanne.obj",
             {0, 0, 1},
             -0.985,
             {{0, 0, 0.8}, {0, -0.8, 0.7}, {1.3, 0.3, -0.5}, {-1.3, 0.3, -0.5}, {0.3, 0.3, 0.8}},
             {{0, 0.98, 0}, {0, 0.4, -0.85}, {0.5, 0.85, -0.1}}},
        Head{"example",
             {0, 0, 1},
             0,
             {{0, 9, 12}, {3, 13, 9}, {0, 1, 9}, {8.4, 11, -2.8}, {-8.4, 11, -2.8}, {0, 2, -8.7}},
             {{0, 24, 0}, {0, 15, -11}, {0, 21.5, 6.5}, {7.5, 17, -0.5}, {-7.5, 17, -0.5}}}),
    [](const auto& head) { return std::string(head.param.file, 3); });

}  // namespace
}  // namespace coif
