#include "coif/hairmesh/brush.h"

#include <gtest/gtest.h>

#include <cmath>

#include "coif/hairmesh/operations.h"
#include "hairmesh/test_meshes.h"

namespace coif {
namespace {

/// A field of 6 × 6 quads, four layers of one unit straight up.
HairMesh field() {
  HairMesh mesh = gridMesh(6, 6);
  for (int k = 0; k < 4; ++k) {
    std::vector<BundleId> all;
    for (const Bundle& bundle : mesh.bundles()) all.push_back(bundle.id);
    ExtrudeOptions up;
    up.direction = Vec3(0, 0, 1);
    EXPECT_TRUE(extrudeFaces(mesh, all, up).ok());
  }
  return mesh;
}

std::uint32_t at(const HairMesh& mesh, double x, double y, std::uint32_t layer) {
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
    const HairVertex& vertex = mesh.vertices()[v];
    if (vertex.layer == layer && (vertex.position - Vec3(x, y, layer)).norm() < 1e-9) return v;
  }
  return kNone;
}

double linkLength(const HairMesh& mesh, std::uint32_t v) {
  return (mesh.position(v) - mesh.position(mesh.vertices()[v].parent)).norm();
}

TEST(Brush, CombKeepsLengthsAndRoots) {
  HairMesh mesh = field();
  const HairMesh before = mesh;
  BrushStroke stroke;
  stroke.path = {{0, 3, 3}, {6, 3, 3}};
  stroke.radius = 1.5, stroke.strength = 0.8;
  ASSERT_TRUE(brush(mesh, stroke).ok());
  double farthest = 0;
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
    if (mesh.vertices()[v].layer == 0) {
      EXPECT_EQ(mesh.position(v), before.position(v));
    } else {
      // Lengths are set anew from the root up, so an error is one rounding of a coordinate below 10.
      EXPECT_NEAR(linkLength(mesh, v), 1, 1e-14);
      farthest = std::max(farthest, mesh.position(v).x() - before.position(v).x());
    }
  }
  EXPECT_GT(farthest, 1) << "hair under the stroke lies over";
  // What hangs above the brushed layer came along.
  EXPECT_GT(mesh.position(at(before, 3, 3, 4)).x(), 3.5);
  EXPECT_EQ(mesh.position(at(before, 3, 0, 4)), before.position(at(before, 3, 0, 4))) << "beyond the radius";
}

TEST(Brush, GrabMovesWhatLayUnderItsStart) {
  HairMesh mesh = field();
  const std::uint32_t centre = at(mesh, 3, 3, 4), half = at(mesh, 4, 3, 4);
  BrushStroke stroke;
  stroke.kind = BrushKind::Grab;
  stroke.path = {{3, 3, 4}, {3, 4, 5}, {3, 5, 4}};
  stroke.radius = 2, stroke.strength = 1, stroke.falloff = Falloff::Linear;
  ASSERT_TRUE(brush(mesh, stroke).ok());
  EXPECT_TRUE(mesh.position(centre).isApprox(Vec3(3, 5, 4)));
  EXPECT_TRUE(mesh.position(half).isApprox(Vec3(4, 4, 4))) << "half way to the rim of a linear brush: half";
}

TEST(Brush, PullGoesOutAndPushComesBackTheSameWay) {
  HairMesh mesh = field();
  const std::uint32_t centre = at(mesh, 3, 3, 4);
  BrushStroke stroke;
  stroke.kind = BrushKind::Pull;
  stroke.path = {{3, 3, 4}};
  stroke.radius = 1.2, stroke.strength = 1;
  ASSERT_TRUE(brush(mesh, stroke).ok());
  EXPECT_NEAR(mesh.position(centre).z(), 4 + 0.1 * 1.2, 1e-12) << "a tenth of the radius a dab";
  EXPECT_NEAR(mesh.position(centre).x(), 3, 1e-12);
  stroke.kind = BrushKind::Push;
  stroke.path = {{3, 3, 4.12}};
  ASSERT_TRUE(brush(mesh, stroke).ok());
  EXPECT_NEAR(mesh.position(centre).z(), 4, 1e-12);
}

TEST(Brush, InflateMovesEachSideItsOwnWay) {
  HairMesh mesh = field();
  BrushStroke stroke;
  stroke.kind = BrushKind::Inflate;
  stroke.path = {{3, 3, 2}};
  stroke.radius = 20, stroke.falloff = Falloff::Constant, stroke.strength = 0.1;
  const HairMesh before = mesh;
  ASSERT_TRUE(brush(mesh, stroke).ok());
  const double by = 0.1 * 0.1 * 20;
  for (const auto& [x, y, way] : {std::tuple(0.0, 3.0, Vec3(-1, 0, 0)), std::tuple(6.0, 3.0, Vec3(1, 0, 0)),
                                  std::tuple(3.0, 0.0, Vec3(0, -1, 0))}) {
    const std::uint32_t v = at(before, x, y, 2);
    EXPECT_TRUE((mesh.position(v) - before.position(v)).isApprox(by * way, 1e-12)) << x << " " << y;
  }
}

TEST(Brush, TwistRollsAboutTheHair) {
  HairMesh mesh = field();
  const HairMesh before = mesh;
  BrushStroke stroke;
  stroke.kind = BrushKind::Twist;
  // Over the side at y = 0, whose normal is −y, along x: hair that stands along z turns about z.
  stroke.path = {{2.5, 0, 2}, {3.5, 0, 2}};
  stroke.radius = 1.8, stroke.falloff = Falloff::Constant, stroke.strength = 1;
  ASSERT_TRUE(brush(mesh, stroke).ok());
  const std::uint32_t v = at(before, 3, 0, 2);
  EXPECT_GT((mesh.position(v) - before.position(v)).norm(), 0.05);
  // Exact for the first dab; then the hair leans a little, and its mean direction with it.
  EXPECT_NEAR(mesh.position(v).z(), 2, 1e-3) << "about the hair's own direction";
  EXPECT_GT(mesh.position(v).x(), 3) << "the near side goes with the finger";
  EXPECT_LT(mesh.position(at(before, 3, 1, 2)).x() - 3, mesh.position(v).x() - 3);
}

TEST(Brush, SmoothRelaxesABump) {
  HairMesh mesh = field();
  const std::uint32_t v = at(mesh, 3, 3, 4);
  mesh.setPosition(v, Vec3(3, 3, 6));
  BrushStroke stroke;
  stroke.kind = BrushKind::Smooth;
  stroke.path = {{3, 3, 6}};
  stroke.radius = 0.5, stroke.strength = 1;
  ASSERT_TRUE(brush(mesh, stroke).ok());
  EXPECT_TRUE(mesh.position(v).isApprox(Vec3(3, 3, 4))) << "the mean of its four neighbours";
}

TEST(Brush, GoingOnLeavesTheBeginningAsItWas) {
  HairMesh some = field(), more = some;
  BrushStroke stroke;
  stroke.path = {{0, 3, 3}, {2, 3, 3}};
  stroke.radius = 1;
  ASSERT_TRUE(brush(some, stroke).ok());
  stroke.path.push_back({6, 3, 3});
  ASSERT_TRUE(brush(more, stroke).ok());
  const HairMesh before = field();
  for (std::uint32_t v = 0; v < some.vertices().size(); ++v) {
    if (before.position(v).x() <= 0.5) {
      EXPECT_EQ(some.position(v), more.position(v));
    }
  }
  EXPECT_NE(some, more);
}

TEST(Brush, ThroughReachesAllAlongADirection) {
  HairMesh ball = field(), through = ball;
  BrushStroke stroke;
  stroke.kind = BrushKind::Grab;
  stroke.path = {{3, 0, 4}, {3, 0, 5}};
  stroke.radius = 0.9, stroke.strength = 1;
  ASSERT_TRUE(brush(ball, stroke).ok());
  stroke.through = Vec3(0, 2, 0);
  ASSERT_TRUE(brush(through, stroke).ok());
  const std::uint32_t back = at(field(), 3, 6, 4);
  EXPECT_EQ(ball.position(back), Vec3(3, 6, 4));
  EXPECT_TRUE(through.position(back).isApprox(Vec3(3, 6, 5)));
}

TEST(Brush, MaskedVerticesStay) {
  HairMesh mesh = field();
  VertexWeights mask(mesh.vertices().size(), 1);
  const std::uint32_t kept = at(mesh, 3, 3, 3);
  mask[kept] = 0;
  BrushStroke stroke;
  stroke.path = {{1, 3, 3}, {5, 3, 3}};
  stroke.radius = 1.5;
  ASSERT_TRUE(brush(mesh, stroke, mask).ok());
  EXPECT_EQ(mesh.position(kept), Vec3(3, 3, 3));
}

TEST(Brush, RefusesWhatItCannotDo) {
  HairMesh mesh = field();
  const HairMesh before = mesh;
  BrushStroke stroke;
  EXPECT_FALSE(brush(mesh, stroke).ok()) << "no point";
  stroke.path = {{0, 0, std::nan("")}};
  EXPECT_FALSE(brush(mesh, stroke).ok());
  stroke.path = {{0, 0, 0}};
  stroke.radius = 0;
  EXPECT_FALSE(brush(mesh, stroke).ok());
  stroke.radius = 1, stroke.strength = 2;
  EXPECT_FALSE(brush(mesh, stroke).ok());
  stroke.strength = -0.5, stroke.kind = BrushKind::Smooth;
  EXPECT_FALSE(brush(mesh, stroke).ok());
  stroke.strength = 0.5;
  EXPECT_FALSE(brush(mesh, stroke, VertexWeights(3, 1)).ok());
  EXPECT_EQ(mesh, before);
}

TEST(Brush, DrawnPointByPointItIsTheSameToTheBit) {
  std::vector<Vec3> path;
  for (int i = 0; i <= 40; ++i)  // steps shorter and longer than from dab to dab
    path.emplace_back(1 + 0.1 * i, 3 + std::sin(0.3 * i), 3 + 0.02 * i * (i % 3));
  VertexWeights mask(field().vertices().size(), 1);
  for (std::size_t v = 0; v < mask.size(); v += 7) mask[v] = 0.3;
  for (BrushKind kind : {BrushKind::Comb, BrushKind::Grab, BrushKind::Push, BrushKind::Pull,
                         BrushKind::Inflate, BrushKind::Twist, BrushKind::Smooth}) {
    BrushStroke stroke;
    stroke.kind = kind, stroke.radius = 1.3, stroke.strength = 0.7;
    stroke.path = {path.front()};
    auto growing = GrowingStroke::begin(field(), stroke, mask);
    ASSERT_TRUE(growing.ok());
    for (std::size_t i = 1; i < path.size(); ++i) {
      ASSERT_TRUE(growing->extend(std::span(path).subspan(i, 1)).ok());
      stroke.path.push_back(path[i]);
      HairMesh whole = field();
      ASSERT_TRUE(brush(whole, stroke, mask).ok());
      EXPECT_TRUE(growing->mesh().value() == whole) << "kind " << int(kind) << ", point " << i;
    }
  }
  auto growing = GrowingStroke::begin(field(), {});
  EXPECT_FALSE(growing.ok()) << "no point";
}

TEST(SoftSelection, FalloffsMeetTheirDefinitions) {
  for (Falloff f : {Falloff::Smooth, Falloff::Linear, Falloff::Sharp, Falloff::Round, Falloff::Constant}) {
    EXPECT_EQ(falloffAt(f, 0), 1);
    EXPECT_EQ(falloffAt(f, 1), 0);
    EXPECT_EQ(falloffAt(f, 7), 0);
  }
  EXPECT_DOUBLE_EQ(falloffAt(Falloff::Smooth, 0.5), 0.5);
  EXPECT_DOUBLE_EQ(falloffAt(Falloff::Linear, 0.25), 0.75);
  EXPECT_DOUBLE_EQ(falloffAt(Falloff::Sharp, 0.5), 0.25);
  EXPECT_DOUBLE_EQ(falloffAt(Falloff::Round, 0.5), std::sqrt(0.75));
  EXPECT_DOUBLE_EQ(falloffAt(Falloff::Constant, 0.99), 1);
}

/// A grid of unit squares in the plane z = 0, folded along its lines of constant x into a prism of `sides`.
HairMesh prism(int columns, int rows, int sides) {
  std::vector<Vec3> positions;
  const double radius = 0.5 / std::sin(M_PI / sides);
  for (int y = 0; y <= rows; ++y) {
    for (int x = 0; x <= columns; ++x) {
      const double angle = 2 * M_PI * x / sides;
      positions.emplace_back(radius * std::cos(angle), y, radius * std::sin(angle));
    }
  }
  std::vector<std::uint32_t> offsets{0}, corners;
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      const auto a = std::uint32_t(y * (columns + 1) + x), up = std::uint32_t(columns + 1);
      corners.insert(corners.end(), {a, a + up, a + up + 1, a + 1});
      offsets.push_back(std::uint32_t(corners.size()));
    }
  }
  return HairMesh::fromRoot(positions, offsets, corners).value();
}

TEST(SoftSelection, AlongTheSurfaceIsTheDistanceOfItsFlatImage) {
  // A prism unrolls into the plane, so its distances are the plane's. Reached by unfolding some forty
  // triangles one after the other, each with a rounding of a few units.
  constexpr int kColumns = 20, kRows = 20;
  for (const HairMesh& mesh : {gridMesh(kColumns, kRows), prism(kColumns, kRows, 24)}) {
    const std::uint32_t chosen[] = {10 * (kColumns + 1) + 10};
    const auto weights = softSelection(mesh, chosen, 9, Falloff::Linear, SoftDistance::Surface);
    ASSERT_TRUE(weights.ok());
    for (int y = 0; y <= kRows; ++y) {
      for (int x = 0; x <= kColumns; ++x) {
        const double flat = std::hypot(x - 10, y - 10),
                     along = 9 * (1 - (*weights)[std::size_t(y * (kColumns + 1) + x)]);
        EXPECT_NEAR(along, std::min(flat, 9.0), 1e-12) << x << ", " << y;
      }
    }
  }
}

TEST(SoftSelection, AlongTheSurfaceCountsFromTheNearestOfSeveral) {
  const HairMesh mesh = gridMesh(20, 20);
  const std::uint32_t chosen[] = {at(mesh, 4, 7, 0), at(mesh, 15, 12, 0)};
  const auto weights = softSelection(mesh, chosen, 12, Falloff::Linear, SoftDistance::Surface);
  double worst = 1;
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
    const double flat = std::min((mesh.position(v) - mesh.position(chosen[0])).norm(),
                                 (mesh.position(v) - mesh.position(chosen[1])).norm()),
                 along = 12 * (1 - (*weights)[v]);
    if (flat < 1e-9) continue;
    EXPECT_GE(along, std::min(flat, 12.0) - 1e-12);
    worst = std::max(worst, along / flat);
  }
  // Where the two parts meet the way goes along sides and diagonals of squares: at worst 1 / cos 22.5°.
  EXPECT_LE(worst, 1 / std::cos(M_PI / 8));
}

TEST(SoftSelection, AlongTheSurfaceDoesNotJumpAGap) {
  // Two fields of hair that stand close to each other and share nothing.
  const std::vector<Vec3> positions{{0, 0, 0},   {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                    {1.1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1.1, 1, 0}};
  const std::vector<std::uint32_t> offsets{0, 4, 8}, corners{0, 1, 2, 3, 4, 5, 6, 7};
  const HairMesh mesh = HairMesh::fromRoot(positions, offsets, corners).value();
  const std::uint32_t chosen[] = {1};
  const auto space = softSelection(mesh, chosen, 3),
             surface = softSelection(mesh, chosen, 3, Falloff::Smooth, SoftDistance::Surface);
  EXPECT_GT((*space)[4], 0.9);
  EXPECT_EQ((*surface)[4], 0);
  EXPECT_GT((*surface)[0], 0);
}

TEST(SelectionAxes, FollowTheHairAndItsOutside) {
  const HairMesh mesh = field();  // straight up in z, its outside square
  const std::uint32_t front[] = {at(mesh, 2, 0, 2), at(mesh, 3, 0, 2)};
  Mat3 expected;
  expected << 1, 0, 0, 0, 0, -1, 0, 1, 0;  // x to the right, y up the hair (z), z out of the front (−y)
  // Means of exact unit vectors, normalised: a few roundings.
  EXPECT_LT((selectionAxes(mesh, front, AxesKind::Hair) - expected).norm(), 1e-14);
  EXPECT_LT((selectionAxes(mesh, front, AxesKind::Normal) - expected).norm(), 1e-14);
  EXPECT_EQ(selectionAxes(mesh, front, AxesKind::World), Mat3(Mat3::Identity()));
  HairMesh leaning = mesh;  // every layer half a unit further to the front
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v)
    leaning.setPosition(v, mesh.position(v) - Vec3(0, 0.5 * mesh.vertices()[v].layer, 0));
  const Vec3 along = Vec3(0, -0.5, 1).normalized(), out = Vec3(0, -1, -0.5).normalized();
  for (AxesKind kind : {AxesKind::Hair, AxesKind::Normal}) {
    const Mat3 axes = selectionAxes(leaning, front, kind);
    EXPECT_LT((axes.col(1) - along).norm(), 1e-14);
    EXPECT_LT((axes.col(2) - out).norm(), 1e-14);
    EXPECT_NEAR(axes.determinant(), 1, 1e-14);
  }
  // Roots have links only upwards; inner ones have no outside: still axes at right angles.
  const std::uint32_t inner[] = {at(mesh, 3, 3, 0)};
  const Mat3 axes = selectionAxes(mesh, inner, AxesKind::Hair);
  EXPECT_LT((axes.col(1) - Vec3(0, 0, 1)).norm(), 1e-14);
  EXPECT_NEAR(axes.determinant(), 1, 1e-14);
}

TEST(Edit, ScalesAlongAnyAxes) {
  HairMesh mesh = field();
  const VertexWeights all(mesh.vertices().size(), 1);
  Mat3 turned;
  turned << 0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1;
  ASSERT_TRUE(scale(mesh, all, Vec3(1, 1, 0), Vec3(2, 1, 1), turned).ok());
  const HairMesh before = field();
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
    const Vec3 d = before.position(v) - Vec3(1, 1, 0), axis = turned.col(0);
    // Twice as far along the first axis; coordinates below 20.
    EXPECT_LT((mesh.position(v) - (before.position(v) + d.dot(axis) * axis)).norm(), 1e-14);
  }
  EXPECT_FALSE(scale(mesh, all, Vec3::Zero(), Vec3::Ones(), Mat3(Mat3::Zero())).ok());
}

}  // namespace
}  // namespace coif
