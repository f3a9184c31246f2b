#include <gtest/gtest.h>

#include "cage_checks.h"
#include "coif/scalp/cage.h"
#include "coif/scalp/example_head.h"
#include "coif/scalp/mesh_report.h"
#include "coif/scalp/weld.h"
#include "shapes.h"

namespace coif {
namespace {

using namespace test;

bool finite(const Cage& cage) {
  for (const Vec3& p : cage.positions)
    if (!p.allFinite()) return false;
  const CageQuality& q = cage.quality;
  return std::isfinite(q.maxAspect) && std::isfinite(q.maxDistance) && std::isfinite(q.minAreaRatio);
}

/// The whole way with any mesh: an answer without NaN or an error with a sentence; never a crash or a hang.
void walk(const PolygonMesh& mesh) {
  EXPECT_NO_THROW({
    (void)inspect(mesh).text();
    const auto welded = weld(mesh, {1e-3});
    if (!welded.ok()) {
      EXPECT_FALSE(welded.error().message.empty());
    }
    const Surface surface(mesh);
    for (auto region : {automaticCap(surface), regionOfAll(mesh)}) {
      if (!region.ok()) {
        EXPECT_FALSE(region.error().message.empty());
        continue;
      }
      for (bool exact : {false, true}) {
        const auto cage = buildCage(mesh, surface, *region, counted(30, exact));
        if (cage.ok()) {
          EXPECT_TRUE(finite(*cage));
        }
        if (!cage.ok()) {
          EXPECT_FALSE(cage.error().message.empty());
        }
      }
    }
  });
}

TEST(Torture, EmptyPointsAndOneTriangle) {
  walk({});
  PolygonMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  walk(mesh);
  addFace(mesh, {0, 1, 2});
  walk(mesh);
  addFace(mesh, {2, 1, 0});
  walk(mesh);
  addFace(mesh, {0, 0, 1});
  walk(mesh);
}

TEST(Torture, NothingButDegenerateFaces) {
  PolygonMesh line = sphere(1);
  for (Vec3& p : line.positions) p = Vec3(p.x(), 0, 0);
  walk(line);
  PolygonMesh point = sphere(1);
  for (Vec3& p : point.positions) p = Vec3(3, 3, 3);
  walk(point);
  PolygonMesh pancake = sphere(2);
  for (Vec3& p : pancake.positions) p.y() = 0;
  walk(pancake);
}

TEST(Torture, NotFiniteAndOutOfRange) {
  for (double bad : {std::nan(""), std::numeric_limits<double>::infinity(), -1e308, 1e308}) {
    PolygonMesh mesh = sphere(2);
    mesh.positions[7].z() = bad;
    walk(mesh);
  }
  PolygonMesh mesh = cube();
  mesh.corners[3] = 1000;
  walk(mesh);
}

TEST(Torture, HugeAndTinyHeadsGiveTheSameCage) {
  const PolygonMesh head = makeExampleHead(16);
  const Surface surface(head);
  const auto cage = buildCage(head, surface, *automaticCap(surface));
  ASSERT_TRUE(cage.ok());
  for (double scale : {0x1p-60, 0x1p60}) {
    PolygonMesh other = head;
    for (Vec3& p : other.positions) p *= scale;
    walk(other);
    const Surface scaled(other);
    const auto region = automaticCap(scaled);
    ASSERT_TRUE(region.ok()) << region.error().text();
    const auto same = buildCage(other, scaled, *region);
    ASSERT_TRUE(same.ok()) << same.error().text();
    ASSERT_EQ(same->positions.size(), cage->positions.size());
    checkCage(*same, scaled);
    for (std::size_t v = 0; v < cage->positions.size(); ++v)
      // Powers of two scale every intermediate number exactly.
      EXPECT_LT((same->positions[v] / scale - cage->positions[v]).norm(), 1e-12 * cage->frame.height);
  }
}

TEST(Torture, RandomSoupAndRandomRegions) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    PolygonMesh soup;
    for (std::uint64_t v = 0; v < 40; ++v) soup.positions.push_back(randomPoint(100 * seed + v, 1));
    const CounterRandom random(seed);
    for (std::uint64_t f = 0; f < 60; ++f) {
      const std::uint32_t a = random.below(4 * f, 40), b = random.below(4 * f + 1, 40),
                          c = random.below(4 * f + 2, 40);
      addFace(soup, {a, b, c});
    }
    walk(soup);
  }
  const PolygonMesh ball = sphere(2);
  const Surface surface(ball);
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const CounterRandom random(7, seed);
    std::vector<std::uint32_t> faces;
    for (std::uint32_t f = 0; f < ball.faceCount(); ++f)
      if (random.uniform(f) < 0.1 + 0.1 * double(seed)) faces.push_back(f);
    const auto cage = buildCage(ball, surface, *regionOfFaces(ball, faces), counted(24));
    if (cage.ok()) {
      EXPECT_TRUE(finite(*cage));
    }
    if (!cage.ok()) {
      EXPECT_FALSE(cage.error().message.empty());
    }
  }
}

TEST(Torture, EveryVertexHasALabelOfItsOwn) {
  const PolygonMesh head = exploded(makeExampleHead(16));
  const Surface surface(head);
  const auto region = automaticCap(surface);
  ASSERT_TRUE(region.ok()) << region.error().text();
  const auto cage = buildCage(head, surface, *region);
  ASSERT_TRUE(cage.ok()) << cage.error().text();
  checkCage(*cage, surface);
}

}  // namespace
}  // namespace coif
