#include "coif/scalp/mirror.h"

#include <gtest/gtest.h>

#include "shapes.h"

namespace coif {
namespace {

using namespace test;

/// A lumpy ball, symmetric in x and in nothing else.
PolygonMesh lump(double asymmetry = 0) {
  PolygonMesh mesh = sphere(3);
  for (Vec3& p : mesh.positions) {
    const double front = std::exp(-4 * (p - Vec3(0, 0.3, 1)).squaredNorm());
    const double side = std::exp(-4 * (p - Vec3(1, 0, 0)).squaredNorm());
    p = (1 + 0.3 * front) * Vec3(0.8 * p.x(), 1.3 * p.y() + 0.2 * p.z(), p.z()) +
        asymmetry * side * Vec3(1, 0, 0);
  }
  return mesh;
}

TEST(Mirror, FindsThePlaneOfATurnedShape) {
  for (std::uint64_t i = 0; i < 6; ++i) {
    const Vec3 axis = randomPoint(i, 1).normalized(), shift = randomPoint(50 + i, 7);
    const Mat3 turn = Eigen::AngleAxisd(0.3 + double(i), axis).toRotationMatrix();
    PolygonMesh mesh = lump();
    for (Vec3& p : mesh.positions) p = turn * p + shift;
    const Surface surface(mesh);
    const auto plane = findMirrorPlane(surface);
    ASSERT_TRUE(plane.ok());
    EXPECT_TRUE(plane->accepted);
    // Stated: rounding, where vertices come in pairs (coordinates up to 10, so 1e-15 of them).
    EXPECT_NEAR(std::abs(plane->normal.dot(turn.col(0))), 1, 1e-12);
    EXPECT_NEAR(plane->side(shift), 0, 1e-11);
    // The samples do not fall on vertices; the two halves are triangulated alike.
    EXPECT_LT(plane->residual, 1e-9);
  }
}

TEST(Mirror, RejectsALopsidedShapeAndSaysHowMuch) {
  const Surface even(lump(0)), odd(lump(0.7));
  EXPECT_TRUE(findMirrorPlane(even)->accepted);
  const auto plane = findMirrorPlane(odd);
  ASSERT_TRUE(plane.ok());
  EXPECT_GT(plane->residual, 0.01);
  EXPECT_FALSE(plane->accepted);
}

TEST(Mirror, KeepsTheGivenDirectionInThePlane) {
  const Surface surface(torus(24, 12));  // symmetric across z too, but z must stay in the plane
  MirrorOptions options;
  options.contains = Vec3::UnitZ();
  const auto plane = findMirrorPlane(surface, {}, options);
  ASSERT_TRUE(plane.ok());
  EXPECT_LT(std::abs(plane->normal.z()), 1e-6);
  EXPECT_TRUE(plane->accepted);
}

TEST(Mirror, TakesTheArtistsPlaneAndMeasuresIt) {
  const Surface surface(lump());
  const auto right = givenMirrorPlane(surface, {0, 0, 0}, {3, 0, 0}),
             wrong = givenMirrorPlane(surface, {0, 0, 0}, {0, 1, 1});
  EXPECT_LT(right->residual, 1e-9);
  EXPECT_GT(wrong->residual, 0.01);
  EXPECT_TRUE(wrong->accepted);
  EXPECT_EQ(givenMirrorPlane(surface, {0, 0, 0}, {0, 0, 0}).error().code, ErrorCode::InvalidArgument);
}

TEST(Mirror, RefusesMeshesWithoutArea) {
  PolygonMesh flat;
  flat.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  addFace(flat, {0, 1, 2});
  EXPECT_EQ(findMirrorPlane(Surface(flat)).error().code, ErrorCode::Degenerate);
  EXPECT_EQ(findMirrorPlane(Surface(PolygonMesh{})).error().code, ErrorCode::Degenerate);
}

}  // namespace
}  // namespace coif
