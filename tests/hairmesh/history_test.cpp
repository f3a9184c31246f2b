#include "coif/hairmesh/history.h"

#include "coif/hairmesh/operations.h"
#include "hairmesh/test_meshes.h"

namespace coif {
namespace {

TEST(History, UndoAndRedoWithLabels) {
  HairMesh mesh = gridMesh(3, 3);
  const HairMesh start = mesh;
  History history;
  EXPECT_EQ(history.undo(mesh).error().code, ErrorCode::NotFound);
  EXPECT_EQ(history.undoLabel(), "");
  ASSERT_TRUE(
      history
          .apply(mesh, "Extrude", [](HairMesh& m) { return extrudeFaces(m, allBundles(m), {.distance = 1}); })
          .ok());
  const HairMesh extruded = mesh;
  ASSERT_TRUE(
      history.apply(mesh, "Delete", [](HairMesh& m) { return deleteFaces(m, std::vector{BundleId{4}}); })
          .ok());
  EXPECT_EQ(history.undoLabel(), "Delete");
  ASSERT_TRUE(history.undo(mesh).ok());
  EXPECT_EQ(canonicalBytes(mesh), canonicalBytes(extruded));
  EXPECT_EQ(history.undoLabel(), "Extrude");
  EXPECT_EQ(history.redoLabel(), "Delete");
  ASSERT_TRUE(history.undo(mesh).ok());
  EXPECT_EQ(canonicalBytes(mesh), canonicalBytes(start));
  // A new step after an undo forgets what was undone.
  HairMesh before = mesh;
  mesh.addGroup("fringe");
  history.record(before, mesh, "Group");
  EXPECT_EQ(history.redoCount(), 0u);
  ASSERT_TRUE(history.undo(mesh).ok());
  EXPECT_EQ(mesh, start);
}

TEST(History, RefusedOperationsAndEmptyStepsLeaveNoTrace) {
  HairMesh mesh = gridMesh(2, 2);
  const HairMesh start = mesh;
  History history;
  EXPECT_FALSE(history
                   .apply(mesh, "Bad",
                          [](HairMesh& m) -> Result<int> {
                            m.setPosition(0, {9, 9, 9});
                            return makeError(ErrorCode::InvalidArgument, "no");
                          })
                   .ok());
  EXPECT_EQ(mesh, start);
  history.record(mesh, mesh, "Nothing");
  EXPECT_EQ(history.undoCount(), 0u);
}

TEST(History, AMoveCostsOneVertex) {
  HairMesh mesh = gridMesh(40, 40);
  History history;
  for (int i = 0; i < 100; ++i) {
    const HairMesh before = mesh;
    mesh.setPosition(5, mesh.position(5) + Vec3(0, 0, 1));
    history.record(before, mesh, "Move");
  }
  // The mesh itself takes about 200 kB; a hundred whole copies would be twenty megabytes.
  EXPECT_LT(history.bytes(), 100u * 1024);
}

TEST(History, NegativeZeroComesBack) {
  HairMesh mesh = gridMesh(1, 1);
  const auto start = canonicalBytes(mesh);
  const HairMesh before = mesh;
  mesh.setPosition(0, {-0.0, 0, 0});
  ASSERT_NE(canonicalBytes(mesh), start);
  History history;
  history.record(before, mesh, "Sign");
  ASSERT_TRUE(history.undo(mesh).ok());
  EXPECT_EQ(canonicalBytes(mesh), start);
}

TEST(History, RefusesAMeshChangedBehindItsBack) {
  HairMesh mesh = gridMesh(2, 2);
  History history;
  ASSERT_TRUE(
      history
          .apply(mesh, "Extrude", [](HairMesh& m) { return extrudeFaces(m, allBundles(m), {.distance = 1}); })
          .ok());
  HairMesh moved = mesh, shrunk = mesh;
  moved.setPosition(12, {5, 5, 5});
  ASSERT_TRUE(deleteFaces(shrunk, std::vector{BundleId{0}}).ok());
  for (HairMesh* other : {&moved, &shrunk}) {
    const HairMesh before = *other;
    EXPECT_EQ(history.undo(*other).error().text(),
              "history: the mesh was changed since without being recorded");
    EXPECT_EQ(*other, before);
  }
  EXPECT_TRUE(history.undo(mesh).ok());
}

}  // namespace
}  // namespace coif
