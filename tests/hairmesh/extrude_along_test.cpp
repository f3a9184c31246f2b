#include <gtest/gtest.h>

#include <cmath>

#include "coif/hairmesh/edit.h"
#include "coif/hairmesh/operations.h"
#include "hairmesh/test_meshes.h"

namespace coif {
namespace {

std::vector<BundleId> all(const HairMesh& mesh) {
  std::vector<BundleId> ids;
  for (const Bundle& bundle : mesh.bundles()) ids.push_back(bundle.id);
  return ids;
}

TEST(ExtrudeAlong, StraightIsLayerAfterLayer) {
  HairMesh once = gridMesh(3, 2), steps = once;
  ExtrudePath path;
  path.layers = 4, path.length = 2;
  const auto created = extrudeAlong(once, all(once), path);
  ASSERT_TRUE(created.ok());
  EXPECT_EQ(created->faces.size(), 6u);
  EXPECT_EQ(created->vertices.size(), 4u * 12u);
  for (int k = 0; k < 4; ++k) ASSERT_TRUE(extrudeFaces(steps, all(steps), {.distance = 0.5}).ok());
  EXPECT_EQ(once, steps);
  EXPECT_TRUE(checkInvariants(once).empty());
}

TEST(ExtrudeAlong, GravityTurnsEachLayerByAPart) {
  HairMesh mesh = gridMesh(1, 1);
  ExtrudePath path;
  path.layers = 3, path.length = 3, path.bend = 0.5, path.towards = Vec3(0, -7, 0);
  ASSERT_TRUE(extrudeAlong(mesh, all(mesh), path).ok());
  Vec3 direction = Vec3::UnitZ(), at = mesh.position(0);
  for (std::uint32_t layer = 1; layer <= 3; ++layer) {
    direction = (0.5 * direction - 0.5 * Vec3::UnitY()).normalized();
    at += direction;
    EXPECT_TRUE(mesh.position(mesh.bundles()[0].face(layer)[0]).isApprox(at, 1e-12)) << layer;
  }
  // All the way down at once, and on from there: the hair's direction, not the face's normal, goes on.
  path.bend = 1, path.layers = 1;
  ASSERT_TRUE(extrudeAlong(mesh, all(mesh), path).ok());
  EXPECT_TRUE(mesh.position(mesh.bundles()[0].face(4)[0]).isApprox(at - 3 * Vec3::UnitY(), 1e-12));
}

TEST(ExtrudeAlong, ACurveCarriesTheTipsAndTurnsThem) {
  HairMesh mesh = gridMesh(2, 2);
  ExtrudePath path;
  path.layers = 8;
  // A quarter circle from up to along x, begun anywhere; of many corners, so that its end turns by 90° less
  // half a corner.
  constexpr int kCorners = 900;
  for (int i = 0; i <= kCorners; ++i) {
    const double t = 0.5 * M_PI * i / kCorners;
    path.curve.push_back(Vec3(30, 40, 50) + 5 * Vec3(1 - std::cos(t), 0, std::sin(t)));
  }
  ASSERT_TRUE(extrudeAlong(mesh, all(mesh), path).ok());
  const double corner = 0.5 * M_PI / kCorners;
  for (const Bundle& bundle : mesh.bundles()) {
    for (std::uint32_t i = 0; i < 4; ++i) {
      const Vec3 root = mesh.position(bundle.face(0)[i]) - Vec3(1, 1, 0);
      const Vec3 tip = mesh.position(bundle.face(8)[i]) - Vec3(1, 1, 0) - Vec3(5, 0, 5);
      EXPECT_NEAR(tip.y(), root.y(), 1e-9);
      EXPECT_NEAR(tip.z(), -root.x(), 2 * corner);
      EXPECT_NEAR(tip.norm(), root.norm(), 1e-9) << "carried as a whole";
    }
  }
  EXPECT_TRUE(checkInvariants(mesh).empty());
}

TEST(ExtrudeAlong, RefusesAndChangesNothing) {
  HairMesh mesh = gridMesh(2, 1);
  const HairMesh before = mesh;
  ExtrudePath path;
  path.layers = 0;
  EXPECT_FALSE(extrudeAlong(mesh, all(mesh), path).ok());
  path.layers = 2, path.bend = 1.5;
  EXPECT_FALSE(extrudeAlong(mesh, all(mesh), path).ok());
  path.bend = 0, path.curve = {{1, 1, 1}, {1, 1, 1}};
  EXPECT_FALSE(extrudeAlong(mesh, all(mesh), path).ok());
  path.curve = {{0, 0, 0}, {0, std::nan(""), 1}};
  EXPECT_FALSE(extrudeAlong(mesh, all(mesh), path).ok());
  path.curve = {};
  EXPECT_FALSE(extrudeAlong(mesh, std::vector{BundleId(99)}, path).ok());
  EXPECT_FALSE(extrudeAlong(mesh, {}, path).ok());
  EXPECT_EQ(mesh, before);
}

TEST(HullNormals, OfABlockPointOutAndInnerVerticesHaveNone) {
  HairMesh mesh = gridMesh(4, 4);
  for (int k = 0; k < 3; ++k) ASSERT_TRUE(extrudeFaces(mesh, all(mesh), {.direction = Vec3(0, 0, 1)}).ok());
  const auto normals = hullNormals(mesh);
  for (std::uint32_t v = 0; v < normals.size(); ++v) {
    const Vec3& p = mesh.position(v);
    const bool side = p.x() == 0 || p.x() == 4 || p.y() == 0 || p.y() == 4;
    if (side) {
      EXPECT_GT(normals[v].dot(p - Vec3(2, 2, p.z())), 0);
    } else {
      EXPECT_TRUE(normals[v].isApprox(Vec3(0, 0, p.z() == 3 ? 1 : 0)));
    }
  }
  EXPECT_TRUE(normals[2].isApprox(Vec3(0, -1, 0))) << "the middle of a side";
}

}  // namespace
}  // namespace coif
