#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "io/mesh_helpers.h"

namespace coif {
namespace {

using namespace test;
using Indices = std::vector<std::uint32_t>;

const std::vector<Vec3> kPoints{{0, 0, 0}, {1, 0, 0}, {1, 1, 0.5}, {0, 1, -2}};
const Indices kCorners{0, 1, 2, 3, 0, 2, 3};

void expectSample(const Result<PolygonMesh>& mesh) {
  ASSERT_TRUE(mesh.ok()) << mesh.error().text();
  EXPECT_EQ(mesh->positions, kPoints);
  EXPECT_EQ(mesh->corners, kCorners);
  EXPECT_EQ(faceSizes(*mesh), (Indices{4, 3}));
}

template <class T>
void put(std::string& out, T value, bool big) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  if (big) std::reverse(bytes, bytes + sizeof(T));
  out.append(bytes, sizeof(T));
}

/// Properties in an unusual order and of many types, with an unknown element between.
std::string binaryPly(bool big) {
  std::string out =
      std::string("ply\nformat ") + (big ? "binary_big_endian" : "binary_little_endian") +
      " 1.0\ncomment made up\nobj_info x\nelement vertex 4\nproperty uchar red\nproperty double z\n"
      "property list uint8 int16 junk\nproperty short x\nproperty float y\n"
      "element edge 2\nproperty int a\nproperty list uint float b\n"
      "element face 2\nproperty ushort flags\nproperty list uint uint vertex_index\nend_header\n";
  for (const Vec3& p : kPoints) {
    put(out, std::uint8_t(7), big);
    put(out, p.z(), big);
    put(out, std::uint8_t(2), big);
    put(out, std::int16_t(-1), big);
    put(out, std::int16_t(5), big);
    put(out, std::int16_t(p.x()), big);
    put(out, float(p.y()), big);
  }
  for (int e = 0; e < 2; ++e) {
    put(out, std::int32_t(-9), big);
    put(out, std::uint32_t(1), big);
    put(out, std::numeric_limits<float>::quiet_NaN(), big);
  }
  std::size_t at = 0;
  for (const std::uint32_t size : {4u, 3u}) {
    put(out, std::uint16_t(1), big);
    put(out, size, big);
    for (std::uint32_t i = 0; i < size; ++i) put(out, kCorners[at++], big);
  }
  return out;
}

constexpr const char* kTextPly =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n1 1 .5\n0 1 -2\n4 0 1 2 3\n3 0 2 3\n";

TEST(Ply, TextAndBothByteOrders) {
  expectSample(meshFrom(kTextPly, "a.ply"));
  expectSample(meshFrom(binaryPly(false), "a.ply"));
  expectSample(meshFrom(binaryPly(true), "a.ply"));
  std::string windows = kTextPly;
  for (std::size_t at = 0; (at = windows.find('\n', at)) != std::string::npos; at += 2)
    windows.insert(at, "\r");
  expectSample(meshFrom(windows, "a.ply"));
  expectSample(meshFrom(kTextPly, "content-beats-extension.stl"));
}

TEST(Ply, ABinaryBodyThatBeginsWithALineFeedLosesNothing) {
  const std::string head =
      "ply\rformat binary_little_endian 1.0\relement vertex 3\rproperty uchar x\rproperty uchar y\r"
      "property uchar z\relement face 1\rproperty list uchar uchar vertex_index\rend_header\r";
  const auto mesh = meshFrom(head + "\n\1\2\3\4\5\6\7\10" + std::string("\3\0\1\2", 4), "a.ply");
  ASSERT_TRUE(mesh.ok()) << mesh.error().text();
  EXPECT_EQ(mesh->positions[0], Vec3(10, 1, 2));
  EXPECT_EQ(mesh->positions[2], Vec3(6, 7, 8));
}

TEST(Ply, UvsOfVerticesAndOfWedges) {
  const std::string faces = "element face 1\nproperty list uchar int vertex_indices\n";
  auto mesh = meshFrom(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float s\nproperty float t\nproperty float x\n"
      "property float y\nproperty float z\n" +
          faces +
          "end_header\n"
          "0 1 0 0 0\n0.5 0.25 1 0 0\n1 1 1 1 0\n3 2 1 0\n",
      "a.ply");
  ASSERT_TRUE(mesh.ok()) << mesh.error().text();
  EXPECT_EQ(mesh->cornerUvs, (std::vector<Vec2>{{1, 1}, {0.5, 0.25}, {0, 1}}));
  mesh = meshFrom(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n" +
          faces +
          "property list uchar float texcoord\nend_header\n0 0 0\n1 0 0\n1 1 0\n"
          "3 0 1 2 6 0 .1 .2 .3 .4 .5\n",
      "a.ply");
  ASSERT_TRUE(mesh.ok()) << mesh.error().text();
  EXPECT_EQ(mesh->cornerUvs, (std::vector<Vec2>{{0, .1}, {.2, .3}, {.4, .5}}));
}

TEST(Ply, StripsBecomeTrianglesOfOneWinding) {
  const auto mesh = meshFrom(
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
      "property float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n9 0 1 2 3 4 -1 0 1 2\n",
      "a.ply");
  ASSERT_TRUE(mesh.ok()) << mesh.error().text();
  EXPECT_EQ(mesh->faceCount(), 4u);
  for (std::size_t f = 0; f < mesh->faceCount(); ++f) {
    std::vector<Vec3> triangle;
    for (const std::uint32_t v : mesh->face(f)) triangle.push_back(mesh->positions[v]);
    EXPECT_GT(newellNormal(triangle).z(), 0) << f;
  }
}

TEST(Ply, ClaimsBeyondTheFileAreRefusedBeforeAllocation) {
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  for (const std::string format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    for (const std::string count : {"4294967295", "9223372036854775807", "99999999999999999999", "-1"}) {
      const std::string head = "ply\nformat " + format + " 1.0\n";
      const auto vertices =
          meshFrom(head + "element vertex " + count + "\n" + xyz + "end_header\n0 0 0\n", "a.ply");
      EXPECT_EQ(errorOf(vertices).code, ErrorCode::Malformed);
      const auto nothing = meshFrom(head + "element nothing " + count + "\nend_header\n0 0 0\n", "a.ply");
      EXPECT_FALSE(nothing.ok());
    }
  }
  const std::string head = "ply\nformat binary_little_endian 1.0\nelement vertex 1\n" + xyz +
                           "element face 1\nproperty list uint int vertex_indices\nend_header\n";
  EXPECT_EQ(
      errorOf(meshFrom(head + std::string(12, '\0') + raw<std::uint32_t>({0xffffffffu, 0, 0, 0}), "a.ply"))
          .code,
      ErrorCode::Malformed);
}

TEST(Ply, FaultsAreNamed) {
  const std::string text = kTextPly;
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    const std::size_t at = changed.rfind(from);
    EXPECT_NE(at, std::string::npos);
    return errorOf(meshFrom(changed.replace(at, from.size(), to), "a.ply"));
  };
  EXPECT_EQ(with("3 0 2 3", "3 0 2 4").code, ErrorCode::Malformed);
  EXPECT_EQ(with("3 0 2 3", "3 0 2 -1").code, ErrorCode::Malformed);
  EXPECT_EQ(with("3 0 2 3", "3 0 2 1.5").code, ErrorCode::Malformed);
  EXPECT_EQ(with("3 0 2 3", "4 0 2 3").code, ErrorCode::Malformed);
  EXPECT_EQ(with("1 1 .5", "1 nan .5").code, ErrorCode::Degenerate);
  EXPECT_EQ(with("1 1 .5", "1 nan .5").place, "line 12");
  EXPECT_EQ(with("1 1 .5", "1 a .5").place, "line 12");
  EXPECT_EQ(with("ascii", "ebcdic").code, ErrorCode::Unsupported);
  EXPECT_EQ(with("float z", "quad z").place, "line 6");
  EXPECT_EQ(with("float z", "float w").code, ErrorCode::Malformed);
  EXPECT_EQ(with("end_header", "no_end").code, ErrorCode::Malformed);
  EXPECT_EQ(with("vertex_indices", "others").code, ErrorCode::Malformed);
}

TEST(Off, PlainColouredAndWithoutKeyword) {
  const std::string body =
      "# a comment\n4 2 0\n0 0 0\n1 0 0 # x\n\n1 1 .5\n0 1 -2\n4 0 1 2 3 255 0 0\n3 0 2 3\n";
  expectSample(meshFrom("OFF\n" + body, "a.off"));
  expectSample(meshFrom(body, "a.off"));
  expectSample(meshFrom("OFF4 2 0\n" + body.substr(body.find("0 0 0\n")), "a.txt"));
  expectSample(meshFrom(
      "COFF\n4 2 0\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n1 1 .5 0 0 0 1\n0 1 -2 0 0 0 1\n4 0 1 2 3\n3 0 2 3\n",
      "a.off"));
  const auto mesh =
      meshFrom("STNOFF\n3 1 0\n0 0 0 0 0 1 .25 .5\n1 0 0 0 0 1 1 0\n0 1 0 0 0 1 0 1\n3 0 1 2\n", "a.off");
  ASSERT_TRUE(mesh.ok()) << mesh.error().text();
  EXPECT_EQ(mesh->cornerUvs, (std::vector<Vec2>{{.25, .5}, {1, 0}, {0, 1}}));
}

TEST(Off, FaultsNameTheirLine) {
  struct Case {
    std::string text;
    ErrorCode code;
    std::string place;
  };
  for (const Case& c :
       {Case{"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", ErrorCode::Malformed, "line 6"},
        Case{"OFF\n3 1 0\n0 0 0\n1 0 inf\n0 1 0\n3 0 1 2\n", ErrorCode::Degenerate, "line 4"},
        Case{"OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n", ErrorCode::Malformed, "line 4"},
        Case{"OFF\n4000000000 1 0\n0 0 0\n", ErrorCode::Malformed, "line 2"},
        Case{"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n9223372036854775807 0 1 2\n", ErrorCode::Malformed, "line 6"},
        Case{"OFF BINARY\n3 1 0\n", ErrorCode::Unsupported, "line 1"},
        Case{"4OFF\n3 1 0\n", ErrorCode::Unsupported, "line 1"},
        Case{"OFF\nx\n", ErrorCode::Malformed, "line 2"}}) {
    const Error error = errorOf(meshFrom(c.text, "a.off"));
    EXPECT_EQ(error.code, c.code) << c.text << error.text();
    EXPECT_EQ(error.place, c.place) << c.text << error.text();
  }
}

std::string binaryStl(std::uint32_t stated, int facets, const std::string& header = "solid but binary") {
  std::string out = header;
  out.resize(80, ' ');
  out += raw<std::uint32_t>({stated});
  for (int f = 0; f < facets; ++f)
    out += raw<float>({0, 0, 1, 0, 0, float(f), 1, 0, 0, 0, 1, 0}) + raw<std::uint16_t>({9});
  return out;
}

TEST(Stl, BinaryIsToldBySizeNotBySolid) {
  const auto mesh = meshFrom(binaryStl(3, 3), "a.stl");
  ASSERT_TRUE(mesh.ok()) << mesh.error().text();
  EXPECT_EQ(mesh->vertexCount(), 9u);
  EXPECT_EQ(mesh->faceCount(), 3u);
  EXPECT_EQ(mesh->positions[6], Vec3(0, 0, 2));
  EXPECT_TRUE(hasNote(mesh->notes, "none are welded"));
  EXPECT_TRUE(hasNote(meshFrom(binaryStl(2, 3), "a.stl")->notes, "50 bytes after"));
  EXPECT_EQ(errorOf(meshFrom(binaryStl(4, 3), "a.stl")).code, ErrorCode::Malformed);
  EXPECT_EQ(errorOf(meshFrom(binaryStl(0xffffffffu, 3), "a.stl")).code, ErrorCode::Malformed);
  EXPECT_EQ(errorOf(meshFrom(binaryStl(0, 0), "a.stl")).code, ErrorCode::Degenerate);
  EXPECT_EQ(errorOf(meshFrom("solid", "a.stl")).code, ErrorCode::Malformed);
}

TEST(Stl, Text) {
  const std::string text =
      "SOLID x\n FACET normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n"
      "   Vertex 0 1e0 0\n  endloop\n endfacet\nendsolid x\n";
  const auto mesh = meshFrom(
      "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
      "endloop\nendfacet\n" +
          text,
      "a.stl");
  ASSERT_TRUE(mesh.ok()) << mesh.error().text();
  EXPECT_EQ(mesh->faceCount(), 2u);
  EXPECT_EQ(mesh->positions[5], Vec3(0, 1, 0));
  EXPECT_EQ(
      errorOf(meshFrom("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 nan 0\n", "a.stl"))
          .place,
      "line 5");
  EXPECT_EQ(
      errorOf(meshFrom("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendfacet\n",
                       "a.stl"))
          .code,
      ErrorCode::Malformed);
  EXPECT_EQ(errorOf(meshFrom("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n", "a.stl")).code,
            ErrorCode::Malformed);
}

TEST(LoadPolygonMesh, SaysWhatAForeignFileIs) {
  EXPECT_NE(errorOf(meshFrom("Kaydara FBX Binary  \0", "a.fbx")).message.find("FBX"), std::string::npos);
  EXPECT_NE(errorOf(meshFrom("PK\x03\x04....", "a.usdz")).message.find("zip"), std::string::npos);
  EXPECT_EQ(errorOf(meshFrom("hello", "a.txt")).code, ErrorCode::Unsupported);
  EXPECT_EQ(errorOf(meshFrom("", "a.obj")).code, ErrorCode::Malformed);
  EXPECT_EQ(errorOf(loadPolygonMesh("/no/such/file.obj")).code, ErrorCode::NotFound);
  EXPECT_EQ(errorOf(loadPolygonMesh(std::filesystem::temp_directory_path())).code, ErrorCode::Unreadable);
  EXPECT_TRUE(meshFrom("# x\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "no-extension").ok());
}

}  // namespace
}  // namespace coif
