#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "io/gltf_sample.h"
#include "io/mesh_helpers.h"

namespace coif {
namespace {

using namespace test;
using Json = nlohmann::json;
using Indices = std::vector<std::uint32_t>;

/// A glTF of one mesh node; `buffer` is embedded as base64 or as the GLB's binary chunk.
Json document(const std::string& buffer) {
  return {{"asset", {{"version", "2.0"}}},
          {"scene", 0},
          {"scenes", {{{"nodes", {0}}}}},
          {"nodes", {{{"mesh", 0}}}},
          {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}}}}}}},
          {"buffers", {{{"byteLength", buffer.size()}}}},
          {"bufferViews", {{{"buffer", 0}, {"byteLength", buffer.size()}}}},
          {"accessors", {{{"bufferView", 0}, {"componentType", 5126}, {"count", 0}, {"type", "VEC3"}}}}};
}

std::string glb(const Json& json, std::string buffer) {
  std::string text = json.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  buffer.resize((buffer.size() + 3) / 4 * 4, '\0');
  return "glTF" +
         raw<std::uint32_t>(
             {2, std::uint32_t(28 + text.size() + buffer.size()), std::uint32_t(text.size()), 0x4E4F534A}) +
         text + raw<std::uint32_t>({std::uint32_t(buffer.size()), 0x004E4942}) + buffer;
}

const std::string kFivePoints = raw<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0});

PolygonMesh loaded(const Json& json, const std::string& buffer) {
  auto mesh = meshFrom(glb(json, buffer), "a.glb");
  EXPECT_TRUE(mesh.ok()) << mesh.error().text();
  return mesh.ok() ? std::move(*mesh) : PolygonMesh();
}

double signedArea(const PolygonMesh& mesh, std::size_t face) {
  std::vector<Vec3> points;
  for (const std::uint32_t v : mesh.face(face)) points.push_back(mesh.positions[v]);
  return newellNormal(points).z() / 2;
}

TEST(GltfMesh, TrianglesStripsAndFansKeepTheirWinding) {
  Json json = document(kFivePoints);
  json["accessors"][0]["count"] = 5;
  json["meshes"][0]["primitives"][0]["mode"] = 5;
  PolygonMesh mesh = loaded(json, kFivePoints);
  EXPECT_EQ(mesh.corners, (Indices{0, 1, 2, 1, 3, 2, 2, 3, 4}));
  for (std::size_t f = 0; f < 3; ++f) EXPECT_GT(signedArea(mesh, f), 0) << f;
  json["meshes"][0]["primitives"][0]["mode"] = 6;
  EXPECT_EQ(loaded(json, kFivePoints).corners, (Indices{1, 2, 0, 2, 3, 0, 3, 4, 0}));
  json["meshes"][0]["primitives"][0]["mode"] = 4;
  json["accessors"][0]["count"] = 3;
  EXPECT_EQ(loaded(json, kFivePoints).corners, (Indices{0, 1, 2}));
  json["meshes"][0]["primitives"][0]["mode"] = 1;
  EXPECT_EQ(errorOf(meshFrom(glb(json, kFivePoints), "a.glb")).code, ErrorCode::Degenerate);
}

TEST(GltfMesh, NodesPlaceAndMirrorsTurnTheWinding) {
  Json json = document(kFivePoints);
  json["accessors"][0]["count"] = 3;
  const double half = std::sqrt(0.5);
  json["nodes"] = {{{"children", {1, 2}}, {"translation", {10, 0, 0}}},
                   {{"mesh", 0}, {"rotation", {0, 0, half, half}}, {"scale", {2, 2, 2}}},
                   {{"mesh", 0}, {"matrix", {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1}}}};
  const PolygonMesh mesh = loaded(json, kFivePoints);
  ASSERT_EQ(mesh.faceCount(), 2u);
  const Vec3 turned[] = {{10, 0, 0}, {10, 2, 0}, {8, 0, 0}, {10, 0, 5}, {9, 0, 5}, {10, 1, 5}};
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_LT((mesh.positions[i] - turned[i]).norm(), 1e-14) << i;  // a few ulp of 10
  EXPECT_GT(signedArea(mesh, 0), 0);
  EXPECT_GT(signedArea(mesh, 1), 0) << "mirrored: the corners must be turned";
  EXPECT_EQ(mesh.metersPerUnit, 1);
}

TEST(GltfMesh, IndicesOfEveryTypeAndTheirBounds) {
  const std::pair<int, std::string> types[] = {{5121, raw<std::uint8_t>({0, 1, 2, 2, 1, 3, 0, 0})},
                                               {5123, raw<std::uint16_t>({0, 1, 2, 2, 1, 3})},
                                               {5125, raw<std::uint32_t>({0, 1, 2, 2, 1, 3})}};
  for (const auto& [type, bytes] : types) {
    const std::string buffer = kFivePoints + bytes;
    Json json = document(buffer);
    json["accessors"][0]["count"] = 5;
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 60}, {"byteLength", bytes.size()}});
    json["accessors"].push_back(
        {{"bufferView", 1}, {"componentType", type}, {"count", 6}, {"type", "SCALAR"}});
    json["meshes"][0]["primitives"][0]["indices"] = 1;
    EXPECT_EQ(loaded(json, buffer).corners, (Indices{0, 1, 2, 2, 1, 3}));
    json["accessors"][0]["count"] = 3;
    const Error error = errorOf(meshFrom(glb(json, buffer), "a.glb"));
    EXPECT_EQ(error.code, ErrorCode::Malformed);
    EXPECT_EQ(error.place, "mesh 0, primitive 0");
  }
}

TEST(GltfMesh, QuantizedStridedSparseAndTexturedVertices) {
  // Shorts with a stride of 8, normalised; UVs as normalised bytes; the third point replaced sparsely.
  const std::string points = raw<std::int16_t>({32767, -32768, 0, 9, 0, 32767, 0, 9, 0, 0, 0, 9});
  const std::string uvs = raw<std::uint8_t>({0, 255, 0, 0, 255, 0, 0, 0, 51, 102, 0, 0});
  const std::string buffer =
      points + uvs + raw<std::uint16_t>({2, 0}) + raw<std::int16_t>({16384, 0, 32767, 0});
  Json json = document(buffer);
  json["extensionsRequired"] = {"KHR_mesh_quantization"};
  json["bufferViews"] = {{{"buffer", 0}, {"byteLength", 24}, {"byteStride", 8}},
                         {{"buffer", 0}, {"byteOffset", 24}, {"byteLength", 12}, {"byteStride", 4}},
                         {{"buffer", 0}, {"byteOffset", 36}, {"byteLength", 2}},
                         {{"buffer", 0}, {"byteOffset", 40}, {"byteLength", 8}}};
  json["accessors"] = {
      {{"bufferView", 0},
       {"componentType", 5122},
       {"normalized", true},
       {"count", 3},
       {"type", "VEC3"},
       {"sparse",
        {{"count", 1},
         {"indices", {{"bufferView", 2}, {"componentType", 5123}}},
         {"values", {{"bufferView", 3}}}}}},
      {{"bufferView", 1}, {"componentType", 5121}, {"normalized", true}, {"count", 3}, {"type", "VEC2"}}};
  json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = 1;
  const PolygonMesh mesh = loaded(json, buffer);
  EXPECT_EQ(mesh.positions[0], Vec3(1, -1, 0));
  EXPECT_EQ(mesh.positions[1], Vec3(0, 1, 0));
  EXPECT_EQ(mesh.positions[2], Vec3(double(16384.0f / 32767.0f), 0, 1));
  ASSERT_EQ(mesh.cornerUvs.size(), 3u);
  EXPECT_EQ(mesh.cornerUvs[0], Vec2(0, 0));  // v counts upwards here
  EXPECT_LT((mesh.cornerUvs[2] - Vec2(0.2, 0.6)).norm(), 1e-7);
  json["accessors"][0]["sparse"]["count"] = 4;
  EXPECT_FALSE(meshFrom(glb(json, buffer), "a.glb").ok());
}

TEST(GltfMesh, BuffersOutsideInsideAndAsText) {
  Json json = document(kFivePoints);
  json["accessors"][0]["count"] = 3;
  TempFolder folder;
  json["buffers"][0]["uri"] = "my%20points.bin";
  putFile(folder / "a.gltf", json.dump());
  Error error = errorOf(loadPolygonMesh(folder / "a.gltf"));
  EXPECT_EQ(error.code, ErrorCode::NotFound);
  EXPECT_NE(error.message.find("my points.bin"), std::string::npos) << error.text();
  putFile(folder / "my points.bin", kFivePoints);
  EXPECT_TRUE(loadPolygonMesh(folder / "a.gltf").ok());
  putFile(folder / "my points.bin", kFivePoints.substr(0, 59));
  EXPECT_EQ(errorOf(loadPolygonMesh(folder / "a.gltf")).code, ErrorCode::Malformed);
  json["buffers"][0]["uri"] = "https://example.org/a.bin";
  EXPECT_EQ(errorOf(meshFrom(json.dump(), "a.gltf")).code, ErrorCode::Unsupported);
  json["buffers"][0] = {
      {"byteLength", 36},
      {"uri", "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}};
  json["bufferViews"][0]["byteLength"] = 36;
  const auto mesh = meshFrom(json.dump(), "a.gltf");
  ASSERT_TRUE(mesh.ok()) << mesh.error().text();
  EXPECT_EQ(mesh->positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
}

TEST(GltfMesh, WhatItCannotReadItNames) {
  Json json = document(kFivePoints);
  json["accessors"][0]["count"] = 3;
  const auto fault = [&](const Json& changed) {
    return errorOf(meshFrom(glb(changed, kFivePoints), "a.glb"));
  };
  Json draco = json;
  draco["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  EXPECT_EQ(fault(draco).code, ErrorCode::Unsupported);
  EXPECT_NE(fault(draco).message.find("KHR_draco_mesh_compression"), std::string::npos);
  draco.erase("extensionsRequired");
  draco["accessors"][0].erase("bufferView");
  draco["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", 0}};
  EXPECT_EQ(fault(draco).code, ErrorCode::Unsupported);
  Json meshopt = json;
  meshopt["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0}};
  EXPECT_EQ(fault(meshopt).code, ErrorCode::Unsupported);
  Json old = json;
  old["asset"]["version"] = "1.0";
  EXPECT_EQ(fault(old).code, ErrorCode::Unsupported);
  Json image = json;  // images must not be touched
  image["images"] = {{{"uri", "data:image/png;base64,AAAA"}}, {{"bufferView", 99}}, {{"uri", "absent.png"}}};
  EXPECT_TRUE(meshFrom(glb(image, kFivePoints), "a.glb").ok());
}

TEST(GltfMesh, EveryBoundIsChecked) {
  Json json = document(kFivePoints);
  json["accessors"][0]["count"] = 3;
  using Pointer = Json::json_pointer;
  struct Case {
    const char* where;
    Json value;
  };
  const std::uint64_t huge = ~std::uint64_t{0};
  for (const Case& c : {Case{"/accessors/0/count", 6},
                        Case{"/accessors/0/count", huge},
                        Case{"/accessors/0/count", std::uint64_t{1} << 60},
                        Case{"/accessors/0/byteOffset", 32},
                        Case{"/accessors/0/byteOffset", huge},
                        Case{"/accessors/0/bufferView", 1},
                        Case{"/accessors/0/type", "VEC2"},
                        Case{"/accessors/0/componentType", 5125},
                        Case{"/accessors/0/componentType", 7},
                        Case{"/bufferViews/0/byteOffset", 61},
                        Case{"/bufferViews/0/byteOffset", huge},
                        Case{"/bufferViews/0/byteLength", 61},
                        Case{"/bufferViews/0/byteLength", huge},
                        Case{"/bufferViews/0/buffer", 1},
                        Case{"/bufferViews/0/byteStride", 252},
                        Case{"/buffers/0/byteLength", 64},
                        Case{"/buffers/0/byteLength", huge},
                        Case{"/nodes/0/mesh", 1},
                        Case{"/scenes/0/nodes/0", 1},
                        Case{"/scenes/0/nodes/0", -2},
                        Case{"/scene", 1},
                        Case{"/nodes/0/children", {0}},
                        Case{"/meshes/0/primitives/0/attributes/POSITION", 1},
                        Case{"/meshes/0/primitives/0/attributes/POSITION", -1},
                        Case{"/meshes/0/primitives/0/attributes/TEXCOORD_0", 0},
                        Case{"/meshes/0/primitives/0/indices", 0},
                        Case{"/meshes/0/primitives/0/indices", 5},
                        Case{"/meshes/0/primitives/0/mode", 7},
                        Case{"/nodes/0/scale", {1e300, 1e300, 1e300}},
                        Case{"/nodes/0/rotation", {0, 0, 0, 0}},
                        Case{"/accessors", 5},
                        Case{"/nodes/0", "x"}}) {
    Json changed = json;
    changed[Pointer(c.where)] = c.value;
    const auto mesh = meshFrom(glb(changed, kFivePoints), "a.glb");
    if (std::string(c.where) == "/nodes/0/scale") {
      EXPECT_TRUE(mesh.ok()) << "1e300 is finite in double";
    } else {
      EXPECT_FALSE(mesh.ok()) << c.where << " = " << c.value;
    }
  }
  // A tree whose every level doubles would be astronomically large: a node may have one parent.
  Json twice = json;
  twice["nodes"] = {{{"children", {1, 1}}}, {{"mesh", 0}}};
  EXPECT_EQ(errorOf(meshFrom(glb(twice, kFivePoints), "a.glb")).code, ErrorCode::Malformed);
  EXPECT_EQ(errorOf(meshFrom(std::string(1 << 20, '['), "a.gltf")).code, ErrorCode::Malformed);
  EXPECT_EQ(errorOf(meshFrom("{\"asset\":" + std::string(1000, '[') + "}", "a.gltf")).code,
            ErrorCode::Malformed);
  std::string wide = "{\"extras\":[0";
  for (int i = 0; i < 8000000; ++i) wide += ",0";
  EXPECT_EQ(errorOf(meshFrom(wide + "]}", "a.gltf")).code, ErrorCode::TooLarge)
      << "JSON of 16 MB takes gigabytes parsed";
  const std::string whole = glb(json, kFivePoints);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(meshFrom(whole.substr(0, size), "a.glb").ok()) << size;
  }
}

TEST(GltfMesh, MaterialsAndNodesAreGroups) {
  Json json = document(kFivePoints);
  json["accessors"][0]["count"] = 3;
  const Json primitive = json["meshes"][0]["primitives"][0];
  json["meshes"] = {{{"primitives", {primitive, primitive}}}};
  json["meshes"][0]["primitives"][1]["material"] = 1;
  json["meshes"][0]["primitives"][0]["material"] = 0;
  json["materials"] = {{{"name", "skin"}}, Json::object()};
  const PolygonMesh mesh = loaded(json, kFivePoints);
  EXPECT_EQ(mesh.groupNames, (std::vector<std::string>{"skin", "material 1"}));
  EXPECT_EQ(mesh.faceGroups, (Indices{0, 1}));
  EXPECT_EQ(mesh.vertexCount(), 3u) << "primitives that share their vertices stay connected";
}

void expectSameStrands(const StrandSet& a, const StrandSet& b) {
  EXPECT_EQ(a.offsets, b.offsets);
  ASSERT_EQ(a.points.size(), b.points.size());
  EXPECT_EQ(std::memcmp(a.points.data(), b.points.data(), a.points.size() * sizeof(Vec3f)), 0)
      << "bit for bit";
  EXPECT_EQ(a.widths, b.widths);
  EXPECT_EQ(a.ids, b.ids);
  EXPECT_EQ(a.rootFaces, b.rootFaces);
  EXPECT_EQ(a.weightOffsets, b.weightOffsets);
  EXPECT_EQ(a.weights, b.weights);
  EXPECT_EQ(a.rootUvs, b.rootUvs);
  EXPECT_EQ(a.groups, b.groups);
  EXPECT_EQ(a.groupNames, b.groupNames);
  EXPECT_EQ(a.guides, b.guides);
  EXPECT_EQ(a.colors, b.colors);
  EXPECT_EQ(a.transparencies, b.transparencies);
  EXPECT_EQ(a.metersPerUnit, b.metersPerUnit);
  EXPECT_EQ(a.upAxis, b.upAxis);
  EXPECT_EQ(a.information, b.information);
}

TEST(GltfStrands, EverythingComesBack) {
  TempFolder folder;
  for (const bool full : {true, false}) {
    const StrandSet set = full ? fullStrands() : plainStrands();
    for (const char* name : {"a.glb", "a.gltf"}) {
      StrandExport what;
      what.strands = &set;
      const auto report = saveStrands(what, folder / name);
      ASSERT_TRUE(report.ok()) << report.error().text();
      EXPECT_EQ(report->bytes, std::filesystem::file_size(folder / name));
      const auto back = loadStrands(folder / name);
      ASSERT_TRUE(back.ok()) << back.error().text();
      expectSameStrands(*back, set);
    }
  }
}

TEST(GltfStrands, RealStrandsComeBack) {
  COIF_NEEDS(sharedData("strands/ponytail.hair"));
  const auto set = loadStrands(sharedData("strands/ponytail.hair"));
  ASSERT_TRUE(set.ok());
  StrandExport what;
  what.strands = &*set;
  TempFolder folder;
  ASSERT_TRUE(saveStrands(what, folder / "a.glb").ok());
  const auto back = loadStrands(folder / "a.glb");
  ASSERT_TRUE(back.ok()) << back.error().text();
  expectSameStrands(*back, *set);
}

TEST(GltfStrands, AGltfWithoutStrandsIsUnsupported) {
  Json json = document(kFivePoints);
  json["accessors"][0]["count"] = 3;
  EXPECT_EQ(errorOf(strandsFrom(glb(json, kFivePoints), "a.glb")).code, ErrorCode::Unsupported);
}

TEST(GltfStrands, NamesThatAreNoUtf8AreReplaced) {
  StrandSet set = plainStrands();
  set.groups.assign(set.strandCount(), 0);
  set.groupNames = {"bad \xff name"};
  StrandExport what;
  what.strands = &set;
  TempFolder folder;
  ASSERT_TRUE(saveStrands(what, folder / "a.glb").ok());
  const auto back = loadStrands(folder / "a.glb");
  ASSERT_TRUE(back.ok()) << back.error().text();
  EXPECT_EQ(back->groupNames[0], "bad \xef\xbf\xbd name");
}

/// Σ of triangle areas of one mesh of the file, found by its group (the material or node name).
double areaOfFallback(const std::filesystem::path& path, double& nearest, double& farthest) {
  // The reader leaves the fall-back out of meshes: rename its role so that it reads it.
  std::string bytes = getFile(path);
  const std::size_t role = bytes.find("\"fallback\"");
  EXPECT_NE(role, std::string::npos);
  bytes.replace(role, 10, "\"xallback\"");
  const auto mesh = meshFrom(bytes, "x.glb");
  EXPECT_TRUE(mesh.ok()) << mesh.error().text();
  double area = 0;
  for (std::size_t f = 0; f < mesh->faceCount(); ++f) {
    std::vector<Vec3> points;
    for (const std::uint32_t v : mesh->face(f)) points.push_back(mesh->positions[v]);
    area += newellNormal(points).norm() / 2;
  }
  nearest = 1e300;
  farthest = 0;
  for (const Vec3& p : mesh->positions) {
    const double r = std::hypot(p.x(), p.z());
    nearest = std::min(nearest, r);
    farthest = std::max(farthest, r);
  }
  return area;
}

TEST(GltfStrands, CardsAndTubesCoverWhatTheStrandsDo) {
  // 40 straight strands upwards, width 0.1, length 2; shown by 10 cards: 4 times as wide.
  StrandSet set;
  set.metersPerUnit = 1;
  for (int s = 0; s < 40; ++s) {
    const float angle = float(2 * M_PI / 40 * s);  // a whole ring: the centre of the roots is its own
    for (int i = 0; i < 5; ++i) set.points.emplace_back(std::cos(angle), 0.5f * float(i), std::sin(angle));
    set.offsets.push_back(set.points.size());
  }
  set.widths.assign(set.points.size(), 0.1f);
  StrandExport what;
  what.strands = &set;
  what.meshStrandLimit = 10;
  TempFolder folder;
  ASSERT_TRUE(saveStrands(what, folder / "cards.glb").ok());
  double nearest = 0, farthest = 0;
  const double covered = 40 * 0.1 * 2;
  EXPECT_NEAR(areaOfFallback(folder / "cards.glb", nearest, farthest), covered,
              1e-5 * covered);  // float positions
  // A card of half width 0.2 stands across the radius: its edges lie at √(1 + 0.2²).
  EXPECT_NEAR(farthest, std::sqrt(1.04), 1e-5);
  EXPECT_NEAR(nearest, std::sqrt(1.04), 1e-5);
  what.mesh = StrandMesh::Tubes;
  ASSERT_TRUE(saveStrands(what, folder / "tubes.glb").ok());
  // A convex body shows a quarter of its surface on average (Cauchy); without its small ends, 1/π of the
  // sides.
  EXPECT_NEAR(areaOfFallback(folder / "tubes.glb", nearest, farthest) / M_PI, covered, 1e-5 * covered);
  what.mesh = StrandMesh::None;
  ASSERT_TRUE(saveStrands(what, folder / "none.glb").ok());
  EXPECT_EQ(errorOf(loadPolygonMesh(folder / "none.glb")).code, ErrorCode::Degenerate);
}

TEST(GltfStrands, TheHeadIsReadBackWithoutTheCards) {
  const StrandSet set = plainStrands();
  const PolygonMesh head = sampleHead();
  StrandExport what;
  what.strands = &set;
  what.head = &head;
  TempFolder folder;
  ASSERT_TRUE(saveStrands(what, folder / "a.glb").ok());
  const auto back = loadPolygonMesh(folder / "a.glb");
  ASSERT_TRUE(back.ok()) << back.error().text();
  EXPECT_EQ(back->faceCount(), 2u * 5 + 1);  // five quads of the open box as triangles, and its one triangle
  EXPECT_TRUE(hasNote(back->notes, "only stand for strands"));
  for (std::size_t c = 0; c < back->corners.size(); ++c) {
    // Centimetres, z up: (x, y, z) → 0.01 (x, z, −y). The UVs are made of the positions.
    const Vec3 p = back->positions[back->corners[c]];
    const Vec2 uv(50 * p.x() + 0.5, 50 * p.y() + 0.5);
    EXPECT_LT((back->cornerUvs[c] - uv).norm(), 1e-6);  // two roundings to float near 1
  }
}

TEST(GltfStrands, AFailedWriteLeavesTheOldFile) {
  TempFolder folder;
  putFile(folder / "a.glb", "old");
  StrandSet set = plainStrands();
  StrandExport what;
  what.strands = &set;
  std::atomic<bool> cancel{true};
  Context context;
  context.cancel = &cancel;
  for (const char* name : {"a.glb", "b.gltf", "c.hair"}) {
    EXPECT_EQ(saveStrands(what, folder / name, context).error().code, ErrorCode::Cancelled) << name;
  }
  EXPECT_EQ(getFile(folder / "a.glb"), "old");
  EXPECT_EQ(folder.entries(), 1u);
  set.offsets = {0};
  for (std::size_t p = 1; p <= set.points.size(); ++p) set.offsets.push_back(p);
  set.widths.clear();
  EXPECT_EQ(saveStrands(what, folder / "a.glb").error().code, ErrorCode::InvalidArgument)
      << "single points only";
}

/// Files for the Khronos validator: tests/python/test_gltf.py runs this test and looks at what it leaves.
TEST(GltfFiles, ForTheValidator) {
  const char* out = std::getenv("COIF_TEST_OUT");
  if (out == nullptr) GTEST_SKIP() << "COIF_TEST_OUT names no folder";
  const StrandSet full = fullStrands(), plain = plainStrands();
  const PolygonMesh head = sampleHead();
  const HairMesh hairMesh = sampleHairMesh();
  const auto save = [&](const StrandSet& set, StrandMesh shape, bool beside, const char* name) {
    StrandExport what;
    what.strands = &set;
    what.mesh = shape;
    if (beside) {
      what.head = &head;
      what.hairMesh = &hairMesh;
    }
    const auto report = saveStrands(what, std::filesystem::path(out) / name);
    EXPECT_TRUE(report.ok()) << report.error().text();
  };
  save(full, StrandMesh::Cards, true, "full.glb");
  save(full, StrandMesh::Tubes, true, "tubes.gltf");
  save(plain, StrandMesh::None, false, "plain.glb");
  const auto real = sharedData("strands/mohawk.hair");
  if (std::filesystem::exists(real)) save(*loadStrands(real), StrandMesh::Cards, false, "mohawk.glb");
}

}  // namespace
}  // namespace coif
