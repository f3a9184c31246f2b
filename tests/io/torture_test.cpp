// Whatever the bytes: a mesh or strands that hold together, or an error that names the file. Never a crash.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "io/formats.h"
#include "io/gltf_sample.h"
#include "io/mesh_helpers.h"

namespace coif {
namespace {

using namespace test;
namespace fs = std::filesystem;

void checkMesh(const Result<PolygonMesh>& mesh, const std::string& what) {
  if (!mesh.ok()) {
    EXPECT_FALSE(mesh.error().message.empty()) << what;
    return;
  }
  EXPECT_TRUE(validate(*mesh).ok()) << what;
  EXPECT_GT(mesh->faceCount(), 0u) << what;
  for (const Vec2& uv : mesh->cornerUvs) ASSERT_TRUE(uv.allFinite()) << what;
}

void checkStrands(const Result<StrandSet>& set, const std::string& what) {
  if (!set.ok()) {
    EXPECT_FALSE(set.error().message.empty()) << what;
    return;
  }
  EXPECT_TRUE(validate(*set).ok()) << what;
  EXPECT_GT(set->strandCount(), 0u) << what;
}

/// Every file of the collection through both loaders.
TEST(Torture, EveryFileThroughBothLoaders) {
  COIF_NEEDS(sharedData("torture"));
  std::size_t files = 0, meshes = 0, strands = 0;
  for (const auto& entry : fs::recursive_directory_iterator(sharedData("torture"))) {
    if (!entry.is_regular_file()) continue;
    ++files;
    const auto mesh = loadPolygonMesh(entry.path());
    checkMesh(mesh, entry.path().string());
    if (!mesh.ok()) {
      EXPECT_EQ(mesh.error().file, entry.path().string());
    }
    meshes += mesh.ok();
    const auto set = loadStrands(entry.path());
    checkStrands(set, entry.path().string());
    if (!set.ok()) {
      EXPECT_EQ(set.error().file, entry.path().string());
    }
    strands += set.ok();
  }
  EXPECT_GT(files, 900u);
  EXPECT_GE(meshes, 60u) << "valid files among them must load";
  EXPECT_EQ(strands, 5u) << "the five valid .hair files";
}

TEST(Torture, ObjModelsByName) {
  COIF_NEEDS(sharedData("torture/obj/models"));
  const auto load = [](const char* name) {
    return loadPolygonMesh(sharedData("torture/obj/models/" + std::string(name)));
  };
  EXPECT_EQ(errorOf(load("test-nan.obj")).code, ErrorCode::Degenerate);
  EXPECT_EQ(errorOf(load("test-nan.obj")).place, "line 12");
  EXPECT_EQ(errorOf(load("invalid-relative-vertex-index.obj")).place, "line 1");
  EXPECT_EQ(errorOf(load("invalid-relative-texture-index.obj")).place, "line 2");
  EXPECT_EQ(errorOf(load("issue-140-zero-face-idx.obj")).code, ErrorCode::Malformed);
  EXPECT_EQ(errorOf(load("invalid-face-definition.obj")).code, ErrorCode::Degenerate);
  EXPECT_EQ(errorOf(load("points-prim.obj")).code, ErrorCode::Degenerate);
  const auto torus = load("catmark_torus_creases0.obj");
  ASSERT_TRUE(torus.ok());
  EXPECT_EQ(torus->vertexCount(), 32u);
  EXPECT_EQ(faceSizes(*torus), std::vector<std::uint32_t>(32, 4));
  const auto cornell = load("cornell_box_multimaterial.obj");
  ASSERT_TRUE(cornell.ok());
  EXPECT_EQ(std::count(cornell->groupNames.begin(), cornell->groupNames.end(), "red"), 1);
  EXPECT_TRUE(load("cube-vertex-w-component.obj").ok());
  EXPECT_TRUE(hasNote(load("cube-vertexcol.obj")->notes, "vertex colours"));
}

TEST(Torture, RealHeads) {
  COIF_NEEDS(sharedData("heads"));
  struct Head {
    const char* name;
    std::size_t vertices, quads, triangles;
  };
  for (const Head& head : {Head{"lee-perry-smith", 8838, 8833, 6}, Head{"suzanne", 507, 468, 32}}) {
    const auto mesh = loadPolygonMesh(sharedData("heads/" + std::string(head.name) + ".obj"));
    ASSERT_TRUE(mesh.ok()) << mesh.error().text();
    EXPECT_EQ(mesh->vertexCount(), head.vertices);
    const auto sizes = faceSizes(*mesh);
    EXPECT_EQ(std::size_t(std::count(sizes.begin(), sizes.end(), 4)), head.quads);
    EXPECT_EQ(std::size_t(std::count(sizes.begin(), sizes.end(), 3)), head.triangles);
    EXPECT_EQ(errorOf(loadStrands(sharedData("heads/" + std::string(head.name) + ".obj"))).code,
              ErrorCode::Unsupported);
  }
  const auto messy = loadPolygonMesh(sharedData("heads/tressfx-ponytail-head.obj"));
  checkMesh(messy, "tressfx");
  ASSERT_TRUE(messy.ok()) << messy.error().text();
  EXPECT_EQ(messy->vertexCount(), 11744u);
  EXPECT_EQ(messy->faceCount(), 17894u);
  EXPECT_EQ(messy->groupNames.size(), 10u);
  EXPECT_TRUE(hasNote(messy->notes, "the file has none")) << "its faces name UVs that it does not hold";
}

/// Files that load, made of everything a reader knows, to be damaged.
std::vector<std::pair<std::string, std::string>> seeds() {
  TempFolder folder;
  const StrandSet set = fullStrands();
  const PolygonMesh head = sampleHead();
  StrandExport what;
  what.strands = &set;
  what.head = &head;
  for (const char* name : {"a.glb", "a.gltf", "a.hair"}) EXPECT_TRUE(saveStrands(what, folder / name).ok());
  EXPECT_TRUE(savePolygonMesh(head, folder / "a.obj").ok());
  std::string stl(80, ' ');
  stl += raw<std::uint32_t>({2});
  for (int f = 0; f < 2; ++f)
    stl += raw<float>({0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0}) + raw<std::uint16_t>({0});
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
      "property list uchar float texcoord\nend_header\n";
  return {
      {"a.glb", getFile(folder / "a.glb")},
      {"a.gltf", getFile(folder / "a.gltf")},
      {"a.hair", getFile(folder / "a.hair")},
      {"a.obj", getFile(folder / "a.obj")},
      {"a.stl", stl},
      {"b.stl",
       "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
       "endfacet\nendsolid\n"},
      {"a.ply", header + raw<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}) + raw<std::uint8_t>({3}) +
                    raw<std::int32_t>({0, 1, 2}) + raw<std::uint8_t>({6}) + raw<float>({0, 0, 1, 0, 0, 1})},
      {"b.ply",
       "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
       "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
      {"a.off",
       "STCOFF\n# x\n3 1 0\n0 0 0 1 0 0 1 0 0\n1 0 0 1 0 0 1 1 0\n0 1 0 1 0 0 1 0 1\n3 0 1 2 255 0 0\n"}};
}

std::string damaged(std::string bytes, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return std::size_t(random() % std::max<std::size_t>(n, 1)); };
  // Headers and structure lie at the front: half of the damage goes there.
  const auto place = [&] {
    return below(below(2) == 0 ? std::min<std::size_t>(bytes.size(), 400) : bytes.size());
  };
  for (std::size_t n = 1 + below(4); n > 0 && !bytes.empty(); --n) {
    switch (below(7)) {
      case 0:
        bytes[place()] ^= char(1 << below(8));
        break;
      case 1:
        bytes[place()] = char(random());
        break;
      case 2:
        bytes.resize(place());
        break;
      case 3: {  // an extreme 32-bit number
        constexpr std::uint32_t kNumbers[] = {0,           0xffffffffu, 0x7fffffffu, 0x80000000u,
                                              0x7fc00000u, 0x7f800000u, 65536};
        if (bytes.size() >= 4) std::memcpy(&bytes[below(bytes.size() - 3)], &kNumbers[below(7)], 4);
        break;
      }
      case 4:
        bytes.insert(place(), bytes.substr(place(), below(64)));
        break;
      case 5:
        bytes.erase(place(), below(64));
        break;
      default: {  // another number where text has one
        const std::size_t digit = bytes.find_first_of("0123456789", place());
        const char* const kNumbers[] = {"-1", "0", "4294967296", "99999999999999999999", "nan", "1e999", "2"};
        if (digit != std::string::npos) bytes.replace(digit, 1, kNumbers[below(7)]);
      }
    }
  }
  return bytes;
}

using MeshReader = Result<PolygonMesh> (*)(io::Bytes, const fs::path&);
using StrandReader = Result<StrandSet> (*)(io::Bytes, const fs::path&);

/// As the loaders do, without the disk: the readers' own promise, then validate().
void readAll(const std::string& bytes, const std::string& name, std::size_t round) {
  const io::Bytes span = std::as_bytes(std::span(bytes.data(), bytes.size()));
  const std::string what = name + " round " + std::to_string(round);
  const std::string extension = name.substr(2);
  const std::pair<const char*, MeshReader> meshReaders[] = {
      {"obj", io::readObj}, {"ply", io::readPly},      {"off", io::readOff},
      {"stl", io::readStl}, {"glb", io::readGltfMesh}, {"gltf", io::readGltfMesh}};
  for (const auto& [key, read] : meshReaders) {
    if (extension == key) checkMesh(read(span, name), what);
  }
  const std::pair<const char*, StrandReader> strandReaders[] = {
      {"hair", io::readHair}, {"glb", io::readGltfStrands}, {"gltf", io::readGltfStrands}};
  for (const auto& [key, read] : strandReaders) {
    if (extension != key) continue;
    const auto set = read(span, name);
    if (set.ok()) {
      EXPECT_TRUE(validate(*set, false).ok()) << what;
    }
  }
}

TEST(Torture, DamagedFilesNeverCrash) {
  for (const auto& [name, bytes] : seeds()) {
    readAll(bytes, name, 0);
    std::mt19937 random(12345);  // its sequence is fixed by the standard
    const std::size_t rounds = bytes.size() > 10000 ? 400 : 1500;
    for (std::size_t round = 1; round <= rounds; ++round) readAll(damaged(bytes, random), name, round);
  }
}

/// The loaders' last word: whatever a damaged file gives is valid and finite.
TEST(Torture, DamagedFilesLoadValidOrNotAtAll) {
  TempFolder folder;
  for (const auto& [name, bytes] : seeds()) {
    std::mt19937 random(777);
    for (std::size_t round = 0; round < 60; ++round) {
      putFile(folder / name, damaged(bytes, random));
      checkMesh(loadPolygonMesh(folder / name), name);
      checkStrands(loadStrands(folder / name), name);
    }
  }
}

}  // namespace
}  // namespace coif
