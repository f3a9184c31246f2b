// What the energy leaves free, and the response to dragging.
#include <gtest/gtest.h>

#include "coif/place/place.h"
#include "make_mesh.h"
#include "reference.h"

namespace coif {
namespace {

using namespace placetest;

constexpr PlaceSolver kSolvers[] = {
    PlaceSolver::Auto,   PlaceSolver::ConjugateGradient,  PlaceSolver::Jacobi,
    PlaceSolver::Tensor, PlaceSolver::IncompleteCholesky, PlaceSolver::Direct};

// Radially grown hair on a closed root: straight columns have E's minimum, and the mean rule chooses them.
TEST(FreeComponents, ClosedScalpGrowsStraight) {
  const std::uint32_t n = 5;
  const auto straight = [&](const Vec3& root, std::uint32_t k, std::uint32_t) -> Vec3 {
    return root * (1 + 0.4 * k) + Vec3(0, 0, 0.1 * k);
  };
  const HairMesh expected = build(cube(4, n), straight);
  for (const PlaceSolver solver : kSolvers) {
    HairMesh mesh = expected;
    for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
      if (mesh.vertices()[v].layer % n != 0) mesh.setPosition(v, Vec3(1, double(v % 7), 2));
    }
    const auto report = place(mesh, {solver, 1e-10});
    ASSERT_TRUE(report.ok()) << report.error().text();
    EXPECT_EQ(report->freeComponents, n - 1);  // one a layer between root and tip
    EXPECT_TRUE(report->converged) << int(solver);
    EXPECT_LT(distance(expected, mesh), 1.01e-10) << int(solver);
    EXPECT_LE(distance(expected, mesh), report->error.value) << int(solver);
  }
}

TEST(FreeComponents, SolversAgreeAndMeansLieOnTheLine) {
  Columns columns = cube(4, 6);
  columns.heights[5] = 4;
  columns.heights[6] = 4;  // layers 1 to 3 stay free: up to a tip's lower exposed edge the surface is closed
  const HairMesh start = build(columns, shaken(0.3, 5));
  HairMesh first = start;
  const auto reference = place(first, {PlaceSolver::Direct, 1e-12});
  ASSERT_TRUE(reference.ok());
  EXPECT_EQ(reference->freeComponents, 3u);
  for (const PlaceSolver solver : kSolvers) {
    HairMesh mesh = start;
    const auto report = place(mesh, {solver, 1e-11});
    ASSERT_TRUE(report.ok());
    EXPECT_TRUE(report->converged);
    EXPECT_LT(distance(first, mesh), 1.2e-11) << int(solver);
  }
  for (std::uint32_t layer = 1; layer <= 3; ++layer) {
    Vec3 mean = Vec3::Zero(), line = Vec3::Zero();
    std::vector<Vec3> target(first.vertices().size(), Vec3::Zero());
    std::vector<int> uses(first.vertices().size(), 0);
    for (const Bundle& b : first.bundles()) {
      for (std::uint32_t i = 0; i < b.corners; ++i) {
        const double t = double(layer) / b.height();
        target[b.face(layer)[i]] +=
            (1 - t) * first.position(b.face(0)[i]) + t * first.position(b.face(b.height())[i]);
        ++uses[b.face(layer)[i]];
      }
    }
    int count = 0;
    for (std::uint32_t v = 0; v < first.vertices().size(); ++v) {
      if (uses[v] == 0) continue;
      ++count;
      mean += first.position(v);
      line += target[v] / uses[v];
    }
    EXPECT_LT((mean - line).norm() / count, 1e-13) << layer;
  }
}

TEST(FreeComponents, APinHoldsItsLayer) {
  HairMesh mesh = build(cube(3, 5), shaken(0.2, 3));
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
    if (mesh.vertices()[v].layer == 2) {
      mesh.setPinned(v, true);
      break;
    }
  }
  const auto report = place(mesh);
  ASSERT_TRUE(report.ok());
  EXPECT_EQ(report->freeComponents, 3u);
}

TEST(Drag, EqualsSolvingAgain) {
  Columns columns = grid(9, 9, 6);
  mixHeights(columns, 9, 3, 2);
  splitLines(columns, 9, 4, 3);
  Columns closed = cube(3, 4);
  for (const HairMesh& start : {build(columns, shaken(0.4, 1)), build(closed, shaken(0.4, 2))}) {
    HairMesh mesh = start;
    const PlaceOptions exact{PlaceSolver::Direct, 1e-13};
    ASSERT_TRUE(place(mesh, exact).ok());
    const auto external = externalVertices(mesh);
    std::vector<std::uint32_t> selection;
    for (std::uint32_t v = 0; v < external.size(); ++v) {
      if (external[v] && v % 5 == 0 && mesh.vertices()[v].layer > 1) selection.push_back(v);
    }
    ASSERT_GT(selection.size(), 3u);
    const Vec3 delta(0.3, -0.2, 0.5);
    HairMesh solved = mesh;
    for (const std::uint32_t v : selection) solved.setPosition(v, mesh.position(v) + delta);
    ASSERT_TRUE(place(solved, exact).ok());
    const auto response = dragResponse(mesh, selection, exact);
    ASSERT_TRUE(response.ok()) << response.error().text();
    HairMesh dragged = mesh;
    std::size_t followers = 0;
    for (std::uint32_t v = 0; v < external.size(); ++v) {
      dragged.setPosition(v, mesh.position(v) + (*response)[v] * delta);
      followers += !external[v] && std::abs((*response)[v]) > 1e-3;
    }
    EXPECT_GT(followers, 10u);
    EXPECT_LT(distance(solved, dragged), 1e-12);
  }
}

TEST(Drag, WholeOutsideMovesEverything) {
  HairMesh mesh = build(grid(6, 6, 5), shaken(0.4, 1));
  const auto external = externalVertices(mesh);
  std::vector<std::uint32_t> all;
  for (std::uint32_t v = 0; v < external.size(); ++v) {
    if (external[v]) all.push_back(v);
  }
  const auto response = dragResponse(mesh, all, {PlaceSolver::Auto, 1e-12});
  ASSERT_TRUE(response.ok());
  for (const double c : *response) EXPECT_NEAR(c, 1, 1e-12);  // a translation has E's gradient 0
  const auto none = dragResponse(mesh, {});
  ASSERT_TRUE(none.ok());
  for (const double c : *none) EXPECT_EQ(c, 0);
}

TEST(Drag, RefusesWhatIsNotExternal) {
  const HairMesh mesh = build(grid(4, 4, 4), shaken(0.4, 1));
  const auto external = externalVertices(mesh);
  const std::uint32_t inside =
      std::uint32_t(std::find(external.begin(), external.end(), 0) - external.begin());
  EXPECT_EQ(dragResponse(mesh, std::vector{inside}).error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(dragResponse(mesh, std::vector{std::uint32_t(external.size())}).error().code,
            ErrorCode::InvalidArgument);
}

}  // namespace
}  // namespace coif
