#include "coif/scalp/example_head.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <set>

#include "scalp/example_head_shape.h"

namespace coif {
namespace {

const PolygonMesh& head() {
  static const PolygonMesh mesh = makeExampleHead();
  return mesh;
}

TEST(ExampleHead, IsOneClosedOrientedSurfaceOfGenusZero) {
  for (const int resolution : {16, 22, 48}) {
    const PolygonMesh mesh = makeExampleHead(resolution);
    ASSERT_TRUE(validate(mesh).ok());
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (std::size_t f = 0; f < mesh.faceCount(); ++f) {
      const auto face = mesh.face(f);
      ASSERT_EQ(face.size(), 4u);
      for (int c = 0; c < 4; ++c) edges[{face[c], face[(c + 1) % 4]}]++;
    }
    for (const auto& [edge, count] : edges) {
      ASSERT_EQ(count, 1);
      ASSERT_EQ(edges.count({edge.second, edge.first}), 1u);
    }
    EXPECT_EQ(
        std::int64_t(mesh.vertexCount()) - std::int64_t(edges.size() / 2) + std::int64_t(mesh.faceCount()),
        2);
  }
  EXPECT_EQ(head().faceCount(), 5760u);
}

TEST(ExampleHead, IsItsOwnMirrorImageToTheBit) {
  std::set<std::tuple<double, double, double>> points;
  for (const Vec3& p : head().positions) points.insert({p.x(), p.y(), p.z()});
  EXPECT_EQ(points.size(), head().vertexCount());  // no two coincide
  for (const Vec3& p : head().positions) ASSERT_EQ(points.count({-p.x(), p.y(), p.z()}), 1u);
}

TEST(ExampleHead, HasTheSizeAndTheVolumeOfAHead) {
  const Box box = bounds(head().positions);
  EXPECT_NEAR(box.hi.y(), 24.0, 0.1);  // the crown of the skull's ellipsoid, fillets aside
  EXPECT_EQ(head().metersPerUnit, 0.01);
  double volume = 0, area = 0;
  for (std::size_t f = 0; f < head().faceCount(); ++f) {
    const auto face = head().face(f);
    for (int t = 1; t < 3; ++t) {
      const Vec3 &a = head().positions[face[0]], &b = head().positions[face[t]],
                 &c = head().positions[face[t + 1]];
      volume += a.dot(b.cross(c)) / 6;
      area += (b - a).cross(c - a).norm() / 2;
    }
  }
  // Wound outward: the volume is positive; head and neck of an adult hold 5 to 7 litres, the shoulders' top
  // some more.
  EXPECT_GT(volume, 4500);
  EXPECT_LT(volume, 9000);
  EXPECT_LT(area, 4000);  // a crumpled surface would have far more than the sphere's 4.84 V^(2/3) = 1800
}

TEST(ExampleHead, LiesOnItsFormulaAndFacesAwayFromIt) {
  std::size_t inward = 0;
  for (std::size_t f = 0; f < head().faceCount(); ++f) {
    std::vector<Vec3> corners;
    Vec3 middle = Vec3::Zero();
    for (const std::uint32_t v : head().face(f)) {
      corners.push_back(head().positions[v]);
      middle += 0.25 * head().positions[v];
    }
    const Vec3 normal = newellNormal(corners).normalized();
    inward += headField(middle + 0.3 * normal) < headField(middle - 0.3 * normal);
  }
  EXPECT_LE(inward,
            2 * head().faceCount() / 1000);  // creases finer than the quads: nostrils, the ears' folds
  double worst = 0, mean = 0;
  for (const Vec3& p : head().positions) {
    worst = std::max(worst, std::abs(headField(p)));
    mean += std::abs(headField(p)) / double(head().vertexCount());
  }
  EXPECT_LT(mean, 0.02);  // the last half step along the tangent leaves the second-order term of it
  EXPECT_LT(worst, 0.6);  // about an edge: only at creases and at the rim of the base
}

TEST(ExampleHead, UnfoldsWithoutOverlap) {
  // Every quad keeps its orientation and the areas add up to the two charts: so no point is covered twice.
  double chart = 0, base = 0;
  for (std::size_t f = 0; f < head().faceCount(); ++f) {
    double area = 0;
    for (int c = 0; c < 4; ++c) {
      const Vec2 &p = head().cornerUvs[4 * f + c], &q = head().cornerUvs[4 * f + (c + 1) % 4];
      area += 0.5 * (p.x() * q.y() - p.y() * q.x());
    }
    ASSERT_GT(area, 0) << "face " << f;
    (head().groupNames[head().faceGroups[f]] == "base" ? base : chart) += area;
  }
  EXPECT_NEAR(chart, 0.875 * 0.875, 1e-9);  // rounding only
  EXPECT_NEAR(base, 0.01, 1e-9);
}

TEST(ExampleHead, HasAScalpOnTop) {
  std::size_t scalp = 0;
  for (std::size_t f = 0; f < head().faceCount(); ++f) {
    if (head().groupNames[head().faceGroups[f]] != "scalp") continue;
    ++scalp;
    for (const std::uint32_t v : head().face(f)) {
      EXPECT_GT(head().positions[v].y(), 3);
      EXPECT_LT(head().positions[v].z(), 9);
    }
  }
  EXPECT_GT(scalp, head().faceCount() / 5);
  EXPECT_LT(scalp, head().faceCount() / 2);
}

}  // namespace
}  // namespace coif
