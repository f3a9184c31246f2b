// What placement is: analytic answers, invariants of the minimiser, and inputs at the edge.
#include "coif/place/place.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <atomic>
#include <cmath>
#include <limits>

#include "make_mesh.h"
#include "reference.h"

namespace coif {
namespace {

using namespace placetest;

HairMesh mixedMesh(std::uint64_t seed) {
  Columns columns = grid(10, 8, 6);
  mixHeights(columns, 10, 2, seed);
  splitLines(columns, 10, 4, 3);
  return build(columns, shaken(0.5, seed));
}

PlaceReport placed(HairMesh& mesh, const PlaceOptions& options = {}) {
  auto report = place(mesh, options);
  EXPECT_TRUE(report.ok()) << report.error().text();
  return *report;
}

// Affine in the root and the layer: E = 0 there, so it is the minimiser wherever the inside starts.
TEST(Place, AffineOutsideGivesAffineInside) {
  Mat3 a;
  a << 1, 0.2, -0.3, 0.1, 0.8, 0.4, 0, 0.3, 1.1;
  const auto affine = [&](const Vec3& root, std::uint32_t layer, std::uint32_t) -> Vec3 {
    return a * root + layer * Vec3(0.1, -0.2, 0.5) + Vec3(3, 4, 5);
  };
  HairMesh expected = build(grid(9, 7, 6), affine), mesh = expected;
  const auto external = externalVertices(mesh);
  for (std::uint32_t v = 0; v < external.size(); ++v) {
    if (!external[v]) mesh.setPosition(v, Vec3(0, 0, double(v)));
  }
  const PlaceReport report = placed(mesh);
  EXPECT_EQ(report.unknowns, 8u * 6u * 5u);
  EXPECT_LT(distance(expected, mesh), 1e-9);  // the default tolerance
  EXPECT_GT(report.energyBefore, 1);
  EXPECT_LT(report.energyAfter, 1e-14);
}

// Any external positions on uniform heights: rows obey L V^k = (1 − k/n) L V^0 + (k/n) L V^n; with the side
// columns straight lines too, the whole inside is the straight line from root to tip.
TEST(Place, StraightSidesGiveStraightColumns) {
  const std::uint32_t n = 5;
  const Columns columns = grid(8, 8, n);
  const auto tip = [](const Vec3& root) {
    return Vec3(root.x() + 0.3 * std::sin(5 * root.y()), root.y() * root.x(), 2 + std::cos(3 * root.x()));
  };
  const auto straight = [&](const Vec3& root, std::uint32_t k, std::uint32_t) -> Vec3 {
    return (1 - double(k) / n) * root + double(k) / n * tip(root);
  };
  HairMesh expected = build(columns, straight), mesh = expected;
  const auto external = externalVertices(mesh);
  for (std::uint32_t v = 0; v < external.size(); ++v) {
    if (!external[v]) mesh.setPosition(v, Vec3::Zero());
  }
  placed(mesh);
  EXPECT_LT(distance(expected, mesh), 1e-9);
}

TEST(Place, MinimumHasNoGradientAndGrowsQuadratically) {
  HairMesh mesh = mixedMesh(3);
  placed(mesh, {PlaceSolver::Direct, 1e-13});
  const double energy = placementEnergy(mesh);
  const auto external = externalVertices(mesh);
  const double step = 1e-3;
  for (std::uint32_t v = 0; v < external.size(); v += 7) {
    if (external[v]) continue;
    for (int c = 0; c < 3; ++c) {
      HairMesh up = mesh, down = mesh;
      up.setPosition(v, mesh.position(v) + step * Vec3::Unit(c));
      down.setPosition(v, mesh.position(v) - step * Vec3::Unit(c));
      const double plus = placementEnergy(up), minus = placementEnergy(down);
      EXPECT_NEAR((plus - minus) / (2 * step), 0, 1e-9 * energy / step);  // rounding of E over the step
      EXPECT_GT(plus - energy, 0.9 * 8 * step * step);  // A_vv = 2 · degree >= 2 · 4 inside a quad grid
    }
  }
}

TEST(Place, RigidMotionCommutes) {
  const HairMesh mesh = mixedMesh(4);
  Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const Vec3 shift(10, -20, 5);
  HairMesh moved = mesh, expected = mesh;
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v)
    moved.setPosition(v, turn * mesh.position(v) + shift);
  const PlaceOptions options{PlaceSolver::Tensor, 1e-12};
  placed(moved, options);
  placed(expected, options);
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
    expected.setPosition(v, turn * expected.position(v) + shift);
  }
  EXPECT_LT(distance(expected, moved), 3e-12);  // two solves' errors and the rounding of the motion
}

TEST(Place, FaceOrderDoesNotMatter) {
  Columns columns = grid(8, 8, 5);
  mixHeights(columns, 8, 2, 11);
  const auto byPlace = [](const Vec3& root, std::uint32_t k, std::uint32_t) -> Vec3 {
    return root + Vec3(0.2 * std::sin(7 * root.x() + k), 0.1 * std::cos(3 * root.y() - k), 0.3 * k);
  };
  HairMesh mesh = build(columns, byPlace);
  Columns reversed = columns;
  std::reverse(reversed.faces.begin(), reversed.faces.end());
  std::reverse(reversed.heights.begin(), reversed.heights.end());
  HairMesh other = build(reversed, byPlace);
  const PlaceOptions options{PlaceSolver::Auto, 1e-12};
  placed(mesh, options);
  placed(other, options);
  for (std::size_t f = 0; f < columns.faces.size(); ++f) {
    const Bundle& a = mesh.bundles()[f];
    const Bundle& b = other.bundles()[columns.faces.size() - 1 - f];
    for (std::size_t i = 0; i < a.vertices.size(); ++i) {
      EXPECT_LT((mesh.position(a.vertices[i]) - other.position(b.vertices[i])).norm(),
                2e-12 * diagonal(mesh));
    }
  }
}

TEST(Place, ExternalAndPinnedStayBitForBit) {
  HairMesh mesh = mixedMesh(5);
  const auto before = externalVertices(mesh);
  std::uint32_t pinned = kNone;
  for (std::uint32_t v = 0; v < before.size(); ++v) {
    if (!before[v]) pinned = v;
  }
  mesh.setPinned(pinned, true);
  const HairMesh start = mesh;
  const auto external = externalVertices(mesh);
  ASSERT_TRUE(external[pinned]);
  placed(mesh);
  std::size_t moved = 0;
  for (std::uint32_t v = 0; v < external.size(); ++v) {
    if (external[v]) {
      EXPECT_EQ(mesh.vertices()[v], start.vertices()[v]);
    } else {
      moved += mesh.position(v) != start.position(v);
    }
  }
  EXPECT_GT(moved, 50u);
}

TEST(Place, StartsFromWhereTheVerticesAre) {
  HairMesh mesh = mixedMesh(6);
  placed(mesh, {PlaceSolver::Tensor, 1e-10});
  HairMesh again = mesh;
  const PlaceReport report = placed(again, {PlaceSolver::Tensor, 1e-9});
  EXPECT_EQ(report.iterations, 0);
  EXPECT_EQ(again, mesh);
}

TEST(Place, NothingInsideIsNoWork) {
  HairMesh empty;
  EXPECT_EQ(placed(empty).unknowns, 0u);
  for (const auto& [nx, height] : {std::pair{1u, 30u}, {5u, 1u}, {5u, 0u}}) {  // one bundle; no layer between
    HairMesh mesh = build(grid(nx, nx, height), shaken(0.3, 1));
    const HairMesh start = mesh;
    const PlaceReport report = placed(mesh);
    EXPECT_EQ(report.unknowns, 0u);
    EXPECT_EQ(report.iterations, 0);
    EXPECT_EQ(mesh, start);
  }
}

TEST(Place, BadInputIsRefusedByName) {
  HairMesh mesh = mixedMesh(7);
  const HairMesh start = mesh;
  EXPECT_EQ(place(mesh, {PlaceSolver::Auto, 0}).error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(place(mesh, {PlaceSolver::Auto, std::nan("")}).error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(place(mesh, {PlaceSolver::Auto, 1e-9, -1}).error().code, ErrorCode::InvalidArgument);
  std::atomic<bool> stop{true};
  Context context;
  context.cancel = &stop;
  EXPECT_EQ(place(mesh, {}, context).error().code, ErrorCode::Cancelled);
  EXPECT_EQ(mesh, start);
  for (const double bad : {std::nan(""), HUGE_VAL, 1e200}) {
    HairMesh broken = start;
    broken.setPosition(17, Vec3(0, bad, 0));
    const auto result = place(broken);
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().code, ErrorCode::Degenerate);
    EXPECT_EQ(result.error().place, "vertex 17");
  }
}

TEST(Place, ExtremeGeometry) {
  const HairMesh base = mixedMesh(8);
  HairMesh truth = base;
  placed(truth, {PlaceSolver::Direct, 1e-13});
  {  // far from the origin: the answer moves along, to the spacing of doubles there (1.2e-7)
    const Vec3 far(1e9, -1e9, 1e9);
    HairMesh mesh = base, expected = base;
    for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
      mesh.setPosition(v, base.position(v) + far);
      expected.setPosition(v, mesh.position(v) - far);  // what of the positions is left after rounding
    }
    placed(expected, {PlaceSolver::Direct, 1e-13});
    const PlaceReport report = placed(mesh);
    EXPECT_TRUE(report.converged);
    double worst = 0;
    for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
      worst = std::max(worst, (mesh.position(v) - far - expected.position(v)).norm());
    }
    EXPECT_LT(worst, 2e-7);
    EXPECT_GE(report.error.value * diagonal(mesh), worst);
  }
  {  // layers whose scales differ by 1e6
    HairMesh mesh = base;
    for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
      mesh.setPosition(v, base.position(v) * std::pow(10.0, mesh.vertices()[v].layer));
    }
    HairMesh direct = mesh;
    placed(direct, {PlaceSolver::Direct, 1e-13});
    const PlaceReport report = placed(mesh, {PlaceSolver::Tensor, 1e-9});
    EXPECT_TRUE(report.converged);
    EXPECT_LT(distance(direct, mesh), 1.01e-9);
  }
  {  // tiny and huge units: the same picture
    for (const double unit : {1e-30, 1e30}) {
      HairMesh mesh = base, expected = truth;
      for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
        mesh.setPosition(v, base.position(v) * unit);
        expected.setPosition(v, truth.position(v) * unit);
      }
      EXPECT_TRUE(placed(mesh).converged);
      EXPECT_LT(distance(expected, mesh), 1.01e-9);
    }
  }
  {  // all in one point
    HairMesh mesh = base;
    for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) mesh.setPosition(v, Vec3(1, 2, 3));
    const HairMesh start = mesh;
    EXPECT_TRUE(placed(mesh).converged);
    EXPECT_EQ(mesh, start);
  }
}

TEST(Place, TallHair) {
  for (const std::uint32_t height : {2u, 50u, 1000u}) {
    HairMesh mesh = build(grid(4, 4, height), shaken(0.2, height));
    HairMesh direct = mesh;
    const PlaceReport exact = placed(direct, {PlaceSolver::Direct, 1e-10});
    EXPECT_TRUE(exact.converged) << exact.error.value;
    const PlaceReport report = placed(mesh);
    EXPECT_EQ(report.solver, PlaceSolver::Tensor);
    EXPECT_TRUE(report.converged) << report.error.value;
    EXPECT_LT(distance(direct, mesh), 1.2e-9);  // both tolerances and their rounding
  }
}

}  // namespace
}  // namespace coif
