// Every solver against a long double reference, and its proven error against its true one.
#include <gtest/gtest.h>

#include <cmath>

#include "coif/place/place.h"
#include "make_mesh.h"
#include "reference.h"

namespace coif {
namespace {

using namespace placetest;

constexpr PlaceSolver kSolvers[] = {
    PlaceSolver::Auto,   PlaceSolver::ConjugateGradient,  PlaceSolver::Jacobi,
    PlaceSolver::Tensor, PlaceSolver::IncompleteCholesky, PlaceSolver::Direct};

struct Case {
  const char* name;
  HairMesh mesh;
};

std::vector<Case> cases() {
  std::vector<Case> out;
  out.push_back({"uniform", build(grid(6, 5, 5), shaken(0.4, 1))});
  Columns mixed = grid(8, 8, 6);
  mixHeights(mixed, 8, 2, 5);
  out.push_back({"mixed", build(mixed, shaken(0.4, 2))});
  splitLines(mixed, 8, 3, 2);
  out.push_back({"mixed and split", build(mixed, shaken(0.4, 3))});
  Columns split = grid(9, 6, 5);
  splitLines(split, 9, 4, 3);
  out.push_back({"split", build(split, shaken(0.4, 4))});
  HairMesh pinned = build(grid(7, 7, 6), shaken(0.4, 5));
  for (std::uint32_t v = 0; v < pinned.vertices().size(); v += 13) pinned.setPinned(v, true);
  out.push_back({"pinned", std::move(pinned)});
  Columns closed = cube(3, 4);
  closed.heights[0] = 1;  // its corners hold every layer of the closed root
  out.push_back({"closed with a short bundle", build(closed, shaken(0.4, 6))});
  HairMesh closedPins = build(cube(3, 4), shaken(0.4, 7));
  std::uint32_t wanted = 1, step = 0;
  for (std::uint32_t v = 0; v < closedPins.vertices().size();
       ++v) {  // one pin a layer, each in another column
    if (closedPins.vertices()[v].layer != wanted || ++step % 7 != 0) continue;
    closedPins.setPinned(v, true);
    ++wanted;
  }
  out.push_back({"closed with a pin a layer", std::move(closedPins)});
  return out;
}

TEST(PlaceSolvers, AgreeWithTheLongDoubleReference) {
  for (const Case& c : cases()) {
    const std::vector<Vec3> expected = referencePositions(c.mesh);
    for (const PlaceSolver solver : kSolvers) {
      HairMesh mesh = c.mesh;
      PlaceOptions options;
      options.solver = solver;
      options.tolerance =
          1e-11;  // far above the rounding of a system with κ < 1e4 (1e-16 · 1e4), far below a fault
      const auto report = place(mesh, options);
      ASSERT_TRUE(report.ok()) << report.error().text();
      EXPECT_TRUE(report->converged) << c.name << int(solver);
      EXPECT_EQ(report->freeComponents, 0u) << c.name;
      ASSERT_GT(report->unknowns, 20u) << c.name;
      double worst = 0;
      for (std::uint32_t v = 0; v < expected.size(); ++v) {
        worst = std::max(worst, (mesh.position(v) - expected[v]).norm());
      }
      EXPECT_LE(worst / diagonal(mesh), report->error.value) << c.name << int(solver);
      EXPECT_LE(report->error.value, 1.01 * options.tolerance) << c.name << int(solver);
    }
  }
}

// The bound is a theorem, so it must hold at every stage of every iteration; and it must not be useless.
TEST(PlaceSolvers, ProvenErrorCoversTheTrueErrorAtEveryTolerance) {
  for (const Case& c : cases()) {
    HairMesh truth = c.mesh;
    const std::vector<Vec3> expected = referencePositions(c.mesh);
    for (std::uint32_t v = 0; v < expected.size(); ++v) truth.setPosition(v, expected[v]);
    for (const PlaceSolver solver : kSolvers) {
      for (const double tolerance : {1e-1, 1e-3, 1e-5, 1e-7, 1e-9}) {
        HairMesh mesh = c.mesh;
        PlaceOptions options;
        options.solver = solver;
        options.tolerance = tolerance;
        const auto report = place(mesh, options);
        ASSERT_TRUE(report.ok());
        const double error = distance(truth, mesh);
        EXPECT_LE(error, report->error.value) << c.name << int(solver) << ' ' << tolerance;
        // √κ and the path-length factors together stay below 1e3 on these meshes; 1e-15 is double's own
        // floor.
        EXPECT_LE(report->error.value, 1e3 * error + 2e-14) << c.name << int(solver) << ' ' << tolerance;
      }
    }
  }
}

TEST(PlaceSolvers, BoundHoldsWhenIterationsRunOut) {
  for (const Case& c : cases()) {
    HairMesh truth = c.mesh;
    ASSERT_TRUE(place(truth, {PlaceSolver::Direct, 1e-13}).ok());
    for (const PlaceSolver solver : {PlaceSolver::ConjugateGradient, PlaceSolver::Tensor}) {
      for (const int iterations : {0, 1, 3, 7}) {
        HairMesh mesh = c.mesh;
        const auto report = place(mesh, {solver, 1e-12, iterations});
        ASSERT_TRUE(report.ok());
        EXPECT_LE(report->iterations, iterations);
        EXPECT_EQ(report->converged, report->error.value <= 1.01e-12);
        EXPECT_LE(distance(truth, mesh), report->error.value + 1e-13) << c.name << ' ' << iterations;
      }
    }
  }
}

TEST(PlaceSolvers, TensorIsExactWhereTheBoxIsFull) {
  for (const std::uint32_t n : {5u, 12u, 30u}) {
    HairMesh mesh = build(grid(n, n + 3, n / 2 + 1), shaken(0.4, n));
    const auto report = place(mesh, {PlaceSolver::Tensor, 1e-10});
    ASSERT_TRUE(report.ok());
    EXPECT_EQ(report->iterations, 1) << n;
    EXPECT_NEAR(report->condition, 1, 1e-6);
    EXPECT_TRUE(report->converged);
  }
}

// κ(T ⊗ L) = κ(T) κ(L), both known: sines on a path, products of sines on a grid.
TEST(PlaceSolvers, ConditionIsTheProductOfTheFactors) {
  const std::uint32_t n = 12, h = 7;
  HairMesh mesh = build(grid(n, n, h), shaken(0.4, 9));
  const auto report = place(mesh, {PlaceSolver::ConjugateGradient, 1e-13});
  ASSERT_TRUE(report.ok());
  const auto path = [](double k, double m) { return 4 * std::pow(std::sin(k * M_PI / (2 * m)), 2); };
  const double expected = path(h - 1, h) / path(1, h) * path(n - 1, n) / path(1, n);
  EXPECT_NEAR(report->condition / expected, 1, 0.01);  // the extreme Ritz values have converged to 1 %
}

TEST(PlaceSolvers, ThreadsDoNotChangeABit) {
  // More unknowns and layers than one task of any parallel loop takes: 65² × 17.
  const HairMesh mesh = build(grid(66, 66, 18), shaken(0.4, 8));
  for (const PlaceOptions& options :
       {PlaceOptions{PlaceSolver::Tensor, 1e-9, 1}, {PlaceSolver::Jacobi, 1e-9, 5}}) {
    HairMesh one = mesh, many = mesh;
    Context single, several;
    single.threads = 1;
    several.threads = 4;
    ASSERT_TRUE(place(one, options, single).ok());
    ASSERT_TRUE(place(many, options, several).ok());
    EXPECT_NE(one, mesh);
    EXPECT_EQ(one, many);
  }
}

}  // namespace
}  // namespace coif
