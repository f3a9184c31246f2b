#include "coif/scalp/mesh_report.h"

#include <gtest/gtest.h>

#include "coif/scalp/weld.h"
#include "shapes.h"

namespace coif {
namespace {

using namespace test;

std::size_t countOf(const MeshReport& report, MeshFault fault) {
  const MeshFinding* f = report.find(fault);
  return f == nullptr ? 0 : f->count;
}

TEST(Validate, NamesTheElement) {
  PolygonMesh mesh = cube();
  EXPECT_TRUE(validate(mesh).ok());
  mesh.corners[9] = 8;
  EXPECT_EQ(validate(mesh).error().place, "face 2");
  mesh = cube();
  mesh.positions[5].y() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(validate(mesh).error().place, "vertex 5");
  mesh = cube();
  mesh.cornerUvs.resize(3);
  EXPECT_EQ(validate(mesh).error().code, ErrorCode::Malformed);
  mesh = cube();
  mesh.faceOffsets = {0, 4, 2, 24};
  EXPECT_FALSE(validate(mesh).ok());
  mesh.faceOffsets.clear();
  EXPECT_FALSE(validate(mesh).ok());
}

TEST(MeshReport, GenusOfSphereTorusAndCup) {
  EXPECT_EQ(inspect(sphere(2)).shells.at(0).genus, 0);
  const MeshReport ring = inspect(torus(20, 10));
  EXPECT_EQ(ring.shells.at(0).genus, 1);
  EXPECT_TRUE(ring.shells[0].closed);
  EXPECT_TRUE(ring.findings.empty());
  PolygonMesh holed = torus(20, 10);
  holed.corners.resize(holed.corners.size() - 4);
  holed.faceOffsets.pop_back();
  EXPECT_EQ(inspect(holed).shells.at(0).genus, 1);
  EXPECT_EQ(inspect(holed).shells.at(0).boundaryLoops, 1u);
  EXPECT_EQ(countOf(inspect(holed), MeshFault::OpenShell), 1u);
}

TEST(MeshReport, VolumeAndAreaOfACube) {
  const Shell shell = inspect(cube()).shells.at(0);
  EXPECT_NEAR(shell.volume, 1, 1e-14);
  EXPECT_NEAR(shell.area, 6, 1e-14);
  PolygonMesh inside = cube();
  for (std::size_t f = 0; f < 6; ++f)
    std::reverse(inside.corners.begin() + 4 * f, inside.corners.begin() + 4 * f + 4);
  EXPECT_NEAR(inspect(inside).shells.at(0).volume, -1, 1e-14);
  EXPECT_EQ(countOf(inspect(inside), MeshFault::InsideOutShell), 1u);
}

TEST(MeshReport, OneFlippedFaceShowsOnItsFourEdges) {
  PolygonMesh mesh = cube();
  std::reverse(mesh.corners.begin(), mesh.corners.begin() + 4);
  const MeshReport report = inspect(mesh);
  EXPECT_EQ(countOf(report, MeshFault::InconsistentWinding), 4u);
  EXPECT_EQ(report.find(MeshFault::InconsistentWinding)->elements.size(), 8u);
  EXPECT_EQ(report.shells[0].genus, -1);
}

TEST(MeshReport, ThreePagesOfABookAndABowTie) {
  PolygonMesh book;
  book.positions = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}};
  for (std::uint32_t k : {2u, 3u, 4u}) addFace(book, {0, 1, k});
  const MeshReport report = inspect(book);
  EXPECT_EQ(countOf(report, MeshFault::NonManifoldEdge), 1u);
  EXPECT_EQ(report.find(MeshFault::NonManifoldEdge)->elements, (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(report.find(MeshFault::NonManifoldEdge)->text, "1 edge has three faces or more.");

  PolygonMesh bow;
  bow.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}};
  addFace(bow, {0, 1, 2});
  addFace(bow, {0, 3, 4});
  EXPECT_EQ(inspect(bow).find(MeshFault::NonManifoldVertex)->elements, std::vector<std::uint32_t>{0});
  EXPECT_EQ(inspect(bow).shells.at(0).boundaryLoops, 2u);
}

TEST(MeshReport, FindsLooseDoubleFlatAndBadThings) {
  PolygonMesh mesh = cube();
  mesh.positions.push_back({9, 9, 9});             // 8: no face
  mesh.positions.push_back(mesh.positions[3]);     // 9: on 3
  mesh.positions.push_back({std::nan(""), 0, 0});  // 10
  addFace(mesh, {0, 1, 1});                        // 6: twice, no area
  addFace(mesh, {9, 0, 3});                        // 7: no area
  addFace(mesh, {0, 1, 77});                       // 8: bad
  addFace(mesh, {10, 4, 5});                       // 9: not finite
  const MeshReport report = inspect(mesh);
  EXPECT_EQ(report.find(MeshFault::UnreferencedVertex)->elements, std::vector<std::uint32_t>{8});
  EXPECT_EQ(report.find(MeshFault::CoincidentVertices)->elements, std::vector<std::uint32_t>{9});
  EXPECT_EQ(report.find(MeshFault::NonFinitePosition)->elements, std::vector<std::uint32_t>{10});
  EXPECT_EQ(report.find(MeshFault::RepeatedCorner)->elements, std::vector<std::uint32_t>{6});
  EXPECT_EQ(report.find(MeshFault::BadFace)->elements, std::vector<std::uint32_t>{8});
  const auto flat = report.find(MeshFault::ZeroAreaFace)->elements;
  EXPECT_TRUE(std::find(flat.begin(), flat.end(), 7u) != flat.end());
  EXPECT_EQ(report.faceShell[8], kNone);
  EXPECT_FALSE(report.text().empty());
}

TEST(MeshReport, CountsShells) {
  const MeshReport report = inspect(exploded(cube()));
  EXPECT_EQ(report.shells.size(), 6u);
  EXPECT_EQ(countOf(report, MeshFault::SeveralShells), 6u);
  EXPECT_EQ(countOf(report, MeshFault::CoincidentVertices), 16u);
}

TEST(Weld, PutsAnExplodedMeshTogetherAndKeepsItsUvs) {
  const PolygonMesh whole = sheet(7, 5);
  const auto welded = weld(exploded(whole));
  ASSERT_TRUE(welded.ok());
  EXPECT_EQ(welded->mesh.vertexCount(), whole.vertexCount());
  EXPECT_EQ(welded->mesh.faceCount(), whole.faceCount());
  EXPECT_EQ(welded->report.mergedVertices, whole.corners.size() - whole.vertexCount());
  for (std::size_t c = 0; c < whole.corners.size(); ++c) {
    EXPECT_EQ(welded->mesh.cornerUvs[c], whole.cornerUvs[c]);
    EXPECT_EQ(welded->mesh.positions[welded->mesh.corners[c]], whole.positions[whole.corners[c]]);
  }
  EXPECT_EQ(inspect(welded->mesh).shells.at(0).genus, 0);
  const auto again = weld(welded->mesh);
  EXPECT_EQ(again->report.mergedVertices, 0u);
}

TEST(Weld, ToleranceIsABoundOnEveryMove) {
  PolygonMesh mesh = exploded(sheet(10, 10));
  for (std::size_t v = 0; v < mesh.vertexCount(); ++v) mesh.positions[v] += randomPoint(v, 1e-4);
  EXPECT_EQ(weld(mesh)->report.mergedVertices, 0u);
  // Two vertices of a corner are at most 2·√3·1e-4 apart.
  const auto welded = weld(mesh, {3.5e-4});
  EXPECT_EQ(welded->mesh.vertexCount(), 121u);
  EXPECT_LE(welded->report.greatestMove, 3.5e-4);
  EXPECT_EQ(inspect(welded->mesh).shells.size(), 1u);
}

TEST(Weld, ChainsDoNotCollapseAndSmallFacesDo) {
  PolygonMesh chain;
  for (int i = 0; i <= 100; ++i)
    chain.positions.emplace_back(i * 0.01, 0, 0), chain.positions.emplace_back(i * 0.01, 1, 0);
  for (std::uint32_t i = 0; i < 100; ++i) addFace(chain, {2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1});
  const auto welded = weld(chain, {0.011});
  ASSERT_TRUE(welded.ok());
  EXPECT_GT(welded->mesh.vertexCount(), 90u);
  EXPECT_EQ(welded->report.droppedFaces.size() + welded->mesh.faceCount(), 100u);
  EXPECT_FALSE(welded->report.droppedFaces.empty());
  EXPECT_TRUE(validate(welded->mesh).ok());
}

TEST(Weld, ReportsEdgesThatBecomeNonManifold) {
  PolygonMesh book;
  for (int page = 0; page < 3; ++page) {
    const auto base = std::uint32_t(book.positions.size());
    book.positions.insert(book.positions.end(), {{0, 0, 0}, {0, 0, 1}, {std::cos(page), std::sin(page), 0}});
    addFace(book, {base, base + 1, base + 2});
  }
  const auto welded = weld(book);
  EXPECT_EQ(welded->report.nonManifoldEdgesBefore, 0u);
  EXPECT_EQ(welded->report.nonManifoldEdgesAfter, 1u);
}

TEST(Weld, RefusesBadInput) {
  PolygonMesh mesh = cube();
  EXPECT_EQ(weld(mesh, {-1}).error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(weld(mesh, {std::nan("")}).error().code, ErrorCode::InvalidArgument);
  mesh.positions[3].x() = std::nan("");
  EXPECT_EQ(weld(mesh).error().place, "vertex 3");
}

}  // namespace
}  // namespace coif
