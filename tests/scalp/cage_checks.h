// What every cage promises.
#pragma once

#include <gtest/gtest.h>

#include <set>

#include "coif/scalp/cage.h"

namespace coif::test {

inline CageOptions counted(int count, bool exact = false) {
  CageOptions options;
  options.count = count;
  options.exact = exact;
  return options;
}

inline void checkOnSurface(const Cage& cage, const Surface& surface) {
  ASSERT_EQ(cage.points.size(), cage.positions.size());
  for (std::size_t v = 0; v < cage.positions.size(); ++v) {
    const SurfacePoint& p = cage.points[v];
    ASSERT_LT(p.triangle, surface.triangleCount());
    EXPECT_EQ(surface.triangleFace(p.triangle), p.face);
    EXPECT_GE(p.barycentric.minCoeff(), 0);
    EXPECT_NEAR(p.barycentric.sum(), 1, 1e-12);
    // Two ways to the same point: rounding of coordinates of the mesh's size.
    EXPECT_LT((surface.at(p.triangle, p.barycentric).position - cage.positions[v]).norm(),
              1e-12 * surface.size());
    EXPECT_LT(surface.nearest(cage.positions[v]).distance, 1e-12 * surface.size());
  }
}

/// All quads, one disc, outward, no folds, every vertex on the head, mirror partners consistent.
inline void checkCage(const Cage& cage, const Surface& surface) {
  checkOnSurface(cage, surface);
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges, directed;
  for (std::size_t f = 0; f < cage.faceCount(); ++f) {
    ASSERT_EQ(cage.faceOffsets[f + 1] - cage.faceOffsets[f], 4u);
    for (std::uint32_t k = 0; k < 4; ++k) {
      const std::uint32_t a = cage.corners[4 * f + k], b = cage.corners[4 * f + (k + 1) % 4];
      edges.insert(std::minmax(a, b));
      EXPECT_TRUE(directed.emplace(a, b).second) << "an edge is run the same way twice";
    }
  }
  EXPECT_EQ(long(cage.positions.size()) - long(edges.size()) + long(cage.faceCount()), 1);
  EXPECT_EQ(cage.faceCount(), std::size_t(cage.columns) * cage.rows);
  EXPECT_EQ(cage.columns % 2, 0u);
  EXPECT_EQ(cage.quality.flips, 0u);
  EXPECT_EQ(cage.quality.mapFlips, 0u);
  for (std::size_t v = 0; v < cage.positions.size(); ++v) {
    EXPECT_LE(cage.uv[v].cwiseAbs().maxCoeff(), 1);
    EXPECT_EQ(cage.boundary[v] != 0, cage.uv[v].cwiseAbs().maxCoeff() == 1);
    if (!cage.mirror) continue;
    EXPECT_EQ(cage.partner[cage.partner[v]], v);
    EXPECT_EQ(cage.uv[cage.partner[v]], Vec2(-cage.uv[v].x(), cage.uv[v].y()));
    if (cage.onPlane[v]) {
      EXPECT_LT(std::abs(cage.mirror->side(cage.positions[v])), 3e-9 * surface.size());
    }
  }
}

}  // namespace coif::test
