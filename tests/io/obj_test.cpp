#include <gtest/gtest.h>

#include "io/mesh_helpers.h"

namespace coif {
namespace {

using namespace test;
using Indices = std::vector<std::uint32_t>;

constexpr const char* kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

PolygonMesh obj(const std::string& text) {
  auto mesh = meshFrom(text, "a.obj");
  EXPECT_TRUE(mesh.ok()) << mesh.error().text();
  return mesh.ok() ? std::move(*mesh) : PolygonMesh();
}

TEST(Obj, QuadsAndNGonsSurvive) {
  const PolygonMesh mesh = obj(std::string(kSquare) + "v 2 2 2\nf 1 2 3 4\nf 1 2 3 4 5\nf 1 2 3\n");
  EXPECT_EQ(faceSizes(mesh), (Indices{4, 5, 3}));
  EXPECT_EQ(mesh.corners, (Indices{0, 1, 2, 3, 0, 1, 2, 3, 4, 0, 1, 2}));
  EXPECT_TRUE(mesh.cornerUvs.empty());
  EXPECT_TRUE(mesh.faceGroups.empty());
}

TEST(Obj, EveryFormOfACorner) {
  const PolygonMesh mesh =
      obj(std::string(kSquare) +
          "vt 0 0\nvt 1 0\nvt .5 1 9\nvn 0 0 1\n"
          "f 1/1 2/2 3/3\nf 1/1/1 2/2/1 3/3/1\nf -4/-3/-1 -3/-2/-1 -2/-1/-1\nf 1//1 2//1 3//1\n");
  EXPECT_EQ(mesh.corners, (Indices{0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2}));
  ASSERT_EQ(mesh.cornerUvs.size(), 12u);
  for (std::size_t f = 0; f < 3; ++f) EXPECT_EQ(mesh.cornerUvs[3 * f + 2], Vec2(0.5, 1));
  EXPECT_EQ(mesh.cornerUvs[11], Vec2(0, 0));
  EXPECT_TRUE(hasNote(mesh.notes, "3 corners have no UV"));
  EXPECT_TRUE(hasNote(mesh.notes, "normals"));
}

TEST(Obj, NegativeIndicesCountBackFromTheFace) {
  const PolygonMesh mesh =
      obj("v 0 0 0\nv 1 0 0\nv 1 1 0\nf -3 -2 -1\nv 0 0 1\nv 1 0 1\nv 1 1 1\nf -3 -2 -1\n");
  EXPECT_EQ(mesh.corners, (Indices{0, 1, 2, 3, 4, 5}));
}

TEST(Obj, UvsThatTheFileNamesButLacksAreLeftOut) {
  const PolygonMesh mesh = obj(std::string(kSquare) + "f 1/1 2/2 3/3\nf -4/-4 -3/-3 -2/-2\n");
  EXPECT_TRUE(mesh.cornerUvs.empty());
  EXPECT_EQ(mesh.corners, (Indices{0, 1, 2, 0, 1, 2}));
  EXPECT_TRUE(hasNote(mesh.notes, "the file has none"));
}

TEST(Obj, LineEndsContinuationsBlanksAndComments) {
  const PolygonMesh plain = obj(std::string(kSquare) + "f 1 2 3 4\n");
  for (const std::string text :
       {"\xEF\xBB\xBFv 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\nf 1 2 3 4\r\n",
        "v 0 0 0\rv 1 0 0\rv 1 1 0\rv 0 1 0\rf 1 2 3 4",
        "# C:\\a\\\n  v\t0  0\t0  \nv 1 \\\n 0 0 # right\nv 1 1\\\r\n 0\nv 0 1 0 1.0\n\n\nf 1 2 \\\n3\\\n 4 "
        "# end",
        "v +0 0. 0e0\nv 1e+0 0 -0\nv 10E-1 1 0\nv 0 1.000 1e-999 .1 .2 .3\nf 1 2 3 4"}) {
    const PolygonMesh mesh = obj(text);
    EXPECT_EQ(mesh.corners, plain.corners) << text;
    EXPECT_EQ(mesh.positions, plain.positions) << text;
  }
}

TEST(Obj, OneLineOfAMillionCorners) {
  std::string text = kSquare;
  text += 'f';
  for (int i = 0; i < 250000; ++i) text += " 1 2 3 4";
  EXPECT_EQ(faceSizes(obj(text)), (Indices{1000000}));
}

TEST(Obj, AFaceMayComeBeforeItsVertices) {
  EXPECT_EQ(obj(std::string("f 1 2 3\n") + kSquare).corners, (Indices{0, 1, 2}));
  const Error error = errorOf(meshFrom(std::string("\nf 1 2 5\n") + kSquare, "a.obj"));
  EXPECT_EQ(error.code, ErrorCode::Malformed);
  EXPECT_EQ(error.place, "line 2");
}

TEST(Obj, GroupsAreWhatTellsFacesApart) {
  const std::string faces = "f 1 2 3\n";
  // Two materials: they win over the groups, which are said to be left out.
  PolygonMesh mesh =
      obj(kSquare + std::string("g a\nusemtl skin\n") + faces + "g b\n" + faces + "usemtl eye\n" + faces);
  EXPECT_EQ(mesh.groupNames, (std::vector<std::string>{"skin", "eye"}));
  EXPECT_EQ(mesh.faceGroups, (Indices{0, 0, 1}));
  EXPECT_TRUE(hasNote(mesh.notes, "groups are left out"));
  // One material tells nothing apart, the groups do.
  mesh = obj(kSquare + std::string("usemtl skin\ng a\n") + faces + "g b c\n" + faces + "g a\n" + faces);
  EXPECT_EQ(mesh.groupNames, (std::vector<std::string>{"a", "b c"}));
  EXPECT_EQ(mesh.faceGroups, (Indices{0, 1, 0}));
  // Objects alone; a face before the first name falls in "default", once.
  mesh = obj(kSquare + faces + "o head\n" + faces + "o default\n" + faces);
  EXPECT_EQ(mesh.groupNames, (std::vector<std::string>{"default", "head"}));
  EXPECT_EQ(mesh.faceGroups, (Indices{0, 1, 0}));
  // A name that no face uses is no group.
  mesh = obj(kSquare + std::string("g unused\ng a\n") + faces);
  EXPECT_EQ(mesh.groupNames, (std::vector<std::string>{"a"}));
}

TEST(Obj, ManyNamesTakeNoQuadraticTime) {
  std::string text = kSquare;
  for (int i = 0; i < 100000; ++i) text += "g n" + std::to_string(i) + "\nf 1 2 3\n";
  EXPECT_EQ(obj(text).groupNames.size(), 100000u);
}

TEST(Obj, FaultsNameTheirLine) {
  struct Case {
    std::string text;
    ErrorCode code;
    std::string place;
  };
  const std::string square = kSquare;
  for (const Case& c : {Case{"v 0 0\nf 1 2 3", ErrorCode::Malformed, "line 1"},
                        Case{"v 0 0 x\n", ErrorCode::Malformed, "line 1"},
                        Case{"v 0 0 0\nv 0 nan 0\n", ErrorCode::Degenerate, "line 2"},
                        Case{"v 0 0 0\nv 0 1.#IND 0\n", ErrorCode::Degenerate, "line 2"},
                        Case{"v 0 0 0\r\nv 0 0 1e999\r\n", ErrorCode::Degenerate, "line 2"},
                        Case{square + "vt inf 0\n", ErrorCode::Degenerate, "line 5"},
                        Case{square + "f 0 1 2\n", ErrorCode::Malformed, "line 5"},
                        Case{square + "f -5 1 2\n", ErrorCode::Malformed, "line 5"},
                        Case{square + "f 1 2 3\nf 1 2 5\n", ErrorCode::Malformed, "line 6"},
                        Case{square + "vt 0 0\nf 1/1 2/1 3/2\n", ErrorCode::Malformed, "line 6"},
                        Case{square + "f 1 2 99999999999999999999\n", ErrorCode::Malformed, "line 5"},
                        Case{square + "f 1 2 4294967299\n", ErrorCode::Malformed, "line 5"},
                        Case{square + "f 1 2 3x\n", ErrorCode::Malformed, "line 5"},
                        Case{square, ErrorCode::Degenerate, ""}}) {
    const Error error = errorOf(meshFrom(c.text, "a.obj"));
    EXPECT_EQ(error.code, c.code) << c.text << error.text();
    EXPECT_EQ(error.place, c.place) << c.text << error.text();
  }
}

TEST(Obj, SmallFacesAndOtherElementsAreCounted) {
  const PolygonMesh mesh = obj(std::string(kSquare) + "f 1 2\nf 1\nf 1 2 3\nl 1 2\np 1\n");
  EXPECT_EQ(mesh.faceCount(), 1u);
  EXPECT_TRUE(hasNote(mesh.notes, "2 faces of fewer than three corners"));
  EXPECT_TRUE(hasNote(mesh.notes, "2 points, lines"));
}

TEST(Obj, WrittenAndReadBackIsTheSame) {
  PolygonMesh mesh;
  mesh.positions = {{0.1, -1e-300, 1.0 / 3}, {1e300, 2, 3}, {5, 6, 7}, {8, 9, 10.5}, {0, 0, 0}};
  for (const Indices& face : {Indices{0, 1, 2, 3}, Indices{0, 1, 2, 3, 4}, Indices{2, 3, 4}})
    mesh.addFace(face);
  for (std::size_t c = 0; c < mesh.corners.size(); ++c)
    mesh.cornerUvs.emplace_back(double(c) / 7, 1.0 - double(c % 3));
  mesh.groupNames = {"hair line", "odd\nname", "unused"};
  mesh.faceGroups = {0, 1, 0};
  TempFolder folder;
  ASSERT_TRUE(savePolygonMesh(mesh, folder / "a.obj").ok());
  const auto back = loadPolygonMesh(folder / "a.obj");
  ASSERT_TRUE(back.ok()) << back.error().text();
  EXPECT_EQ(back->positions, mesh.positions);
  EXPECT_EQ(back->corners, mesh.corners);
  EXPECT_EQ(back->faceOffsets, mesh.faceOffsets);
  EXPECT_EQ(back->cornerUvs, mesh.cornerUvs);
  EXPECT_EQ(back->faceGroups, mesh.faceGroups);
  EXPECT_EQ(back->groupNames, (std::vector<std::string>{"hair line", "odd_name"}));
  EXPECT_EQ(savePolygonMesh(mesh, folder / "a.ply").error().code, ErrorCode::Unsupported);
  mesh.corners[0] = 5;
  EXPECT_FALSE(savePolygonMesh(mesh, folder / "a.obj").ok());
}

}  // namespace
}  // namespace coif
