#include "coif/scalp/region.h"

#include <gtest/gtest.h>

#include "coif/scalp/geodesic.h"
#include "coif/scalp/mesh_report.h"
#include "shapes.h"

namespace coif {
namespace {

using namespace test;

TEST(Geodesic, IsExactOnAFlatSheet) {
  const Surface surface(sheet(20, 13));
  const SurfacePoint seed = surface.nearest({0.37, 0.41, 0});
  const auto d = geodesicDistances(surface, std::span(&seed, 1));
  ASSERT_TRUE(d.ok());
  for (std::size_t v = 0; v < d->size(); ++v)
    // Unfolding forty triangles in a row: roundings of numbers below 1.
    EXPECT_NEAR((*d)[v], (surface.mesh().positions[v] - seed.position).norm(), 1e-12);
}

TEST(Geodesic, OnASphereWithinItsStatedErrorAndConverging) {
  double errors[2];
  for (int level : {3, 4}) {
    const PolygonMesh mesh = sphere(level);
    const Surface surface(mesh);
    const SurfacePoint seed = surface.nearest(mesh.positions[5]);
    const auto d = geodesicDistances(surface, std::span(&seed, 1));
    double worst = 0;
    for (std::size_t v = 0; v < mesh.vertexCount(); ++v) {
      const double truth = std::acos(std::clamp(mesh.positions[v].dot(mesh.positions[5]), -1.0, 1.0));
      if (truth > 0.2) worst = std::max(worst, std::abs((*d)[v] / truth - 1));
      EXPECT_GE((*d)[v], (mesh.positions[v] - mesh.positions[5]).norm() - 1e-12);
    }
    errors[level - 3] = worst;
  }
  RecordProperty("worst", std::to_string(errors[1]));
  EXPECT_LT(errors[1], 0.02);  // stated in geodesic.h
  EXPECT_LT(errors[1], errors[0]);
}

TEST(Geodesic, CrossesSeamsAndStopsAtGaps) {
  PolygonMesh mesh = exploded(sheet(10, 10));
  const auto apart = std::uint32_t(mesh.positions.size());
  for (double x : {5.0, 6.0, 5.5}) mesh.positions.emplace_back(x, x * x, 0);
  addFace(mesh, {apart, apart + 1, apart + 2});
  mesh.cornerUvs.clear();
  const Surface surface(mesh);
  const SurfacePoint seed = surface.nearest({0, 0, 0});
  const auto d = geodesicDistances(surface, std::span(&seed, 1));
  for (std::size_t v = 0; v < apart; ++v) EXPECT_NEAR((*d)[v], mesh.positions[v].norm(), 1e-12);
  EXPECT_EQ((*d)[apart], std::numeric_limits<double>::infinity());
  EXPECT_FALSE(geodesicDistances(surface, {}).ok());
  const SurfacePoint nowhere;
  EXPECT_FALSE(geodesicDistances(surface, std::span(&nowhere, 1)).ok());
}

TEST(Region, ByGroupFaceAndShell) {
  PolygonMesh mesh = exploded(cube());
  mesh.groupNames = {"skin", "hair"};
  mesh.faceGroups = {0, 1, 0, 0, 1, 0};
  const std::vector<std::string> hair{"hair"}, beard{"beard"};
  EXPECT_EQ(regionOfGroups(mesh, hair)->list(), (std::vector<std::uint32_t>{1, 4}));
  const Error missing = regionOfGroups(mesh, beard).error();
  EXPECT_EQ(missing.code, ErrorCode::NotFound);
  EXPECT_NE(missing.message.find("skin, hair"), std::string::npos);
  const std::vector<std::uint32_t> faces{2, 5}, outside{6};
  EXPECT_EQ(regionOfFaces(mesh, faces)->list(), faces);
  EXPECT_EQ(regionOfFaces(mesh, outside).error().place, "face 6");
  EXPECT_EQ(regionOfShell(mesh, 3u)->list(), std::vector<std::uint32_t>{3});
  EXPECT_EQ(regionOfShell(mesh, {}, true)->count(), 6u);
  EXPECT_EQ(regionOfShell(mesh, 6u).error().code, ErrorCode::NotFound);
}

TEST(Region, HalfSpaceSphereAndDiscHaveTheRightArea) {
  const PolygonMesh mesh = sphere(4);
  const auto area = [&](const Region& region) {
    double sum = 0;
    for (std::uint32_t f : region.list()) {
      const auto v = mesh.face(f);
      sum += 0.5 * (mesh.positions[v[1]] - mesh.positions[v[0]])
                       .cross(mesh.positions[v[2]] - mesh.positions[v[0]])
                       .norm();
    }
    return sum;
  };
  // Archimedes: a cap of height h has area 2πh. Faces on its rim count whole: half an edge (0.035) times 2π.
  const double tolerance = 2 * std::numbers::pi * 0.035;
  EXPECT_NEAR(area(*regionOfHalfSpace(mesh, {0, 0.3, 0}, {0, 5, 0})), 2 * std::numbers::pi * 0.7, tolerance);
  // Chord c from the pole: height c²/2.
  EXPECT_NEAR(area(*regionOfSphere(mesh, {0, 1, 0}, 0.8)), 2 * std::numbers::pi * 0.32, tolerance);
  const Surface surface(mesh);
  EXPECT_NEAR(area(*regionOfGeodesicDisc(surface, {0, 2, 0}, 1.0)),
              2 * std::numbers::pi * (1 - std::cos(1.0)), tolerance);
  EXPECT_EQ(regionOfHalfSpace(mesh, {0, 3, 0}, {0, 1, 0}).error().code, ErrorCode::Degenerate);
  EXPECT_EQ(regionOfSphere(mesh, {0, 0, 0}, -1).error().code, ErrorCode::InvalidArgument);
}

TEST(Region, CombinesAsSets) {
  const PolygonMesh mesh = sphere(3);
  const Region up = *regionOfHalfSpace(mesh, {0, 0, 0}, {0, 1, 0}),
               right = *regionOfHalfSpace(mesh, {0, 0, 0}, {1, 0, 0});
  const Region both = *intersection(up, right), either = *unionOf(up, right), less = *difference(up, right);
  EXPECT_EQ(both.count() + either.count(), up.count() + right.count());
  EXPECT_EQ(less.count() + both.count(), up.count());
  EXPECT_EQ(both.field.size(), mesh.vertexCount());
  EXPECT_FALSE(intersection(up, *difference(right, up)).ok());
  EXPECT_FALSE(intersection(up, *regionOfAll(cube())).ok());
}

TEST(AutomaticCap, OnASphereIsTheUpperCapWithANote) {
  PolygonMesh mesh = sphere(4);
  for (UpAxis axis : {UpAxis::Y, UpAxis::Z}) {
    mesh.upAxis = axis;
    const Surface surface(mesh);
    const auto cap = automaticCap(surface);
    ASSERT_TRUE(cap.ok()) << cap.error().text();
    EXPECT_FALSE(cap->frame->faceFound);
    EXPECT_FALSE(cap->notes.empty());
    EXPECT_NEAR(double(cap->count()) / double(mesh.faceCount()), 0.5, 0.1);
    for (std::uint32_t f : cap->list())
      EXPECT_GT(mesh.positions[mesh.face(f)[0]][axis == UpAxis::Y ? 1 : 2], -0.2);
  }
}

TEST(AutomaticCap, RefusesDirectionsThatSayNothing) {
  const Surface surface(sphere(2));
  CapOptions options;
  options.head.forward = Vec3(0, 3, 0);
  EXPECT_EQ(automaticCap(surface, options).error().code, ErrorCode::InvalidArgument);
  options = {};
  options.head.up = Vec3::Zero();
  EXPECT_EQ(automaticCap(surface, options).error().code, ErrorCode::InvalidArgument);
}

}  // namespace
}  // namespace coif
