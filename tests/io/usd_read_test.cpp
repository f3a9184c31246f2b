// USD in: round trips, OpenUSD's own test layers, files that usd-core wrote, and broken bytes.
#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <numeric>

#include "coif/base/random.h"
#include "io/formats.h"
#include "io/usd_curves.h"
#include "usd_fixture.h"

namespace coif {
namespace {

namespace fs = std::filesystem;

io::Bytes bytesOf(std::string_view text) {
  return std::as_bytes(std::span(text));
}

PolygonMesh meshOf(std::string_view text) {
  auto mesh = io::readUsdMesh(bytesOf(text), "test.usda");
  EXPECT_TRUE(mesh.ok()) << mesh.error().text();
  return mesh.ok() ? *mesh : PolygonMesh();
}

StrandSet strandsOf(std::string_view text) {
  auto strands = io::readUsdStrands(bytesOf(text), "test.usda");
  EXPECT_TRUE(strands.ok()) << strands.error().text();
  return strands.ok() ? *strands : StrandSet();
}

Error strandError(std::string_view text) {
  auto strands = io::readUsdStrands(bytesOf(text), "test.usda");
  EXPECT_FALSE(strands.ok());
  return strands.ok() ? Error() : strands.error();
}

template <class T>
std::vector<T> picked(const std::vector<T>& values, const std::vector<std::size_t>& order) {
  std::vector<T> out;
  for (const std::size_t i : order) out.push_back(values[i]);
  return out;
}

template <class T>
void expectSameBits(const std::vector<T>& a, const std::vector<T>& b, const char* what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(T)), 0) << what;
}

/// Strands by group, in their order within it: what a file of one prim a group keeps.
StrandSet byGroup(const StrandSet& set) {
  std::vector<std::size_t> strands(set.strandCount()), points;
  std::iota(strands.begin(), strands.end(), 0);
  std::stable_sort(strands.begin(), strands.end(),
                   [&](std::size_t a, std::size_t b) { return set.groups[a] < set.groups[b]; });
  StrandSet out = set;
  out.offsets = {0};
  out.weightOffsets = {0};
  out.weights.clear();
  for (const std::size_t s : strands) {
    for (std::uint64_t i = set.offsets[s]; i < set.offsets[s + 1]; ++i) points.push_back(i);
    out.offsets.push_back(points.size());
    out.weights.insert(out.weights.end(), set.weights.begin() + std::ptrdiff_t(set.weightOffsets[s]),
                       set.weights.begin() + std::ptrdiff_t(set.weightOffsets[s + 1]));
    out.weightOffsets.push_back(out.weights.size());
  }
  out.points = picked(set.points, points);
  out.widths = picked(set.widths, points);
  out.colors = picked(set.colors, points);
  out.transparencies = picked(set.transparencies, points);
  out.ids = picked(set.ids, strands);
  out.rootFaces = picked(set.rootFaces, strands);
  out.rootUvs = picked(set.rootUvs, strands);
  out.groups = picked(set.groups, strands);
  out.guides = picked(set.guides, strands);
  return out;
}

class UsdForm : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Usd, UsdForm, testing::Values("a.usda", "a.usdc"),
                         [](const auto& i) { return std::string(i.param + 2); });

TEST_P(UsdForm, RoundTripKeepsEveryBit) {
  const TemporaryFolder folder("usd_round");
  const StrandSet source = richStrands(3000);
  StrandExport what;
  what.strands = &source;
  const fs::path path = folder / GetParam();
  ASSERT_TRUE(io::writeUsd(what, path, {}).ok());
  const auto read = io::readUsdStrands(readFile(path).value(), path);
  ASSERT_TRUE(read.ok()) << read.error().text();
  const StrandSet expected = byGroup(source);
  expectSameBits(read->offsets, expected.offsets, "offsets");
  expectSameBits(read->points, expected.points, "points");
  expectSameBits(read->widths, expected.widths, "widths");
  expectSameBits(read->colors, expected.colors, "colors");
  expectSameBits(read->transparencies, expected.transparencies, "transparencies");
  expectSameBits(read->ids, expected.ids, "ids");
  expectSameBits(read->rootFaces, expected.rootFaces, "rootFaces");
  expectSameBits(read->rootUvs, expected.rootUvs, "rootUvs");
  expectSameBits(read->groups, expected.groups, "groups");
  expectSameBits(read->guides, expected.guides, "guides");
  expectSameBits(read->weights, expected.weights, "weights");
  expectSameBits(read->weightOffsets, expected.weightOffsets, "weightOffsets");
  EXPECT_EQ(read->groupNames, source.groupNames);
  EXPECT_EQ(read->information, source.information);
  EXPECT_EQ(read->metersPerUnit, source.metersPerUnit);
  EXPECT_EQ(read->upAxis, source.upAxis);
  EXPECT_TRUE(validate(*read).ok());
}

TEST_P(UsdForm, HeadComesBackWithoutTheHairMesh) {
  const TemporaryFolder folder("usd_head");
  const StrandSet strands = richStrands(3);
  const PolygonMesh head = groupedCube();
  const auto hairMesh = HairMesh::fromRoot(head.positions, head.faceOffsets, head.corners);
  ASSERT_TRUE(hairMesh.ok()) << hairMesh.error().text();
  StrandExport what;
  what.strands = &strands;
  what.head = &head;
  what.hairMesh = &*hairMesh;
  const fs::path path = folder / GetParam();
  ASSERT_TRUE(io::writeUsd(what, path, {}).ok());
  const auto read = io::readUsdMesh(readFile(path).value(), path);
  ASSERT_TRUE(read.ok()) << read.error().text();
  EXPECT_EQ(read->positions, head.positions);
  EXPECT_EQ(read->faceOffsets, head.faceOffsets);
  EXPECT_EQ(read->corners, head.corners);
  EXPECT_EQ(read->cornerUvs, head.cornerUvs);
  EXPECT_EQ(read->faceGroups, head.faceGroups);
  EXPECT_EQ(read->groupNames, head.groupNames);
  EXPECT_EQ(read->metersPerUnit, 0.01);
  EXPECT_EQ(read->upAxis, UpAxis::Z);
  EXPECT_FALSE(read->notes.empty());  // the guide mesh is left out
}

TEST_P(UsdForm, RestPointsOfACache) {
  const TemporaryFolder folder("usd_cache");
  const StrandSet strands = richStrands(5);
  const std::vector<Vec3f> moved(strands.pointCount(), Vec3f::Ones());
  StrandExport what;
  what.strands = &strands;
  what.frames = {{1, moved}, {2, moved}};
  const fs::path path = folder / GetParam();
  ASSERT_TRUE(io::writeUsd(what, path, {}).ok());
  const auto read = io::readUsdStrands(readFile(path).value(), path);
  ASSERT_TRUE(read.ok()) << read.error().text();
  expectSameBits(read->points, byGroup(strands).points, "points");
}

TEST_P(UsdForm, BrokenBytesNeverCrash) {
  const TemporaryFolder folder("usd_fuzz");
  const StrandSet strands = richStrands(16);
  const PolygonMesh head = groupedCube();
  StrandExport what;
  what.strands = &strands;
  what.head = &head;
  what.frames = {{1, strands.points}};
  const fs::path path = folder / GetParam();
  ASSERT_TRUE(io::writeUsd(what, path, {}).ok());
  const std::vector<std::byte> good = readFile(path).value();
  const CounterRandom random(11);
  int refused = 0;
  constexpr int kMutations = 4000;
  for (int m = 0; m < kMutations; ++m) {
    const CounterRandom r = random.child(std::uint64_t(m));
    std::vector<std::byte> bytes = good;
    // Half of the faults go to the tables at the end of a crate: there a byte steers most.
    const std::uint32_t reach = r.below(0, 2) == 0
                                    ? std::uint32_t(good.size())
                                    : std::min<std::uint32_t>(3000, std::uint32_t(good.size()));
    for (std::uint32_t k = 0; k <= r.below(1, 4); ++k) {
      bytes[good.size() - 1 - r.below(10 + k, reach)] = std::byte(r.bits(20 + k));
    }
    if (r.below(2, 8) == 0) bytes.resize(r.below(3, std::uint32_t(good.size())));
    const auto readStrands = io::readUsdStrands(bytes, path);
    if (readStrands.ok()) {
      EXPECT_TRUE(validate(*readStrands).ok());
    } else {
      ++refused;
      EXPECT_FALSE(readStrands.error().message.empty());
    }
    (void)io::readUsdMesh(bytes, path);
  }
  EXPECT_GT(refused, kMutations / 20);  // the faults do reach the reader
}

TEST_P(UsdForm, EveryTruncationIsAnError) {
  const TemporaryFolder folder("usd_short");
  const StrandSet strands = richStrands(4);
  StrandExport what;
  what.strands = &strands;
  const fs::path path = folder / GetParam();
  ASSERT_TRUE(io::writeUsd(what, path, {}).ok());
  const std::vector<std::byte> good = readFile(path).value();
  const std::size_t end = good.size() - 2;  // text: without the last line end it is still whole
  for (std::size_t size = 0; size < end; size += 1 + end / 2000) {
    const auto read = io::readUsdStrands(io::Bytes(good).first(size), path);
    EXPECT_FALSE(read.ok()) << size;
  }
}

// Curves.

using io::usd::curveKind;
using io::usd::curveTaps;

double tapSum(const io::usd::Tap& tap) {
  return double(tap.weight[0]) + tap.weight[1] + tap.weight[2] + tap.weight[3];
}

Vec3 tapPoint(const io::usd::Tap& tap, const std::vector<Vec3>& vertices) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < 4; ++i) sum += double(tap.weight[i]) * vertices[tap.vertex[i]];
  return sum;
}

/// De Boor's recursion on uniform knots: independent of the weights in usd_curves.cpp.
Vec3 deBoor(const std::vector<Vec3>& p, std::size_t segment, double t) {
  Vec3 d[4] = {p[segment], p[segment + 1], p[segment + 2], p[segment + 3]};
  for (int r = 1; r <= 3; ++r) {
    for (int j = 3; j >= r; --j) {
      const double a = (t + 3 - j) / (4 - r);
      d[j] = (1 - a) * d[j - 1] + a * d[j];
    }
  }
  return d[3];
}

std::vector<Vec3> zigzag(std::size_t n) {
  std::vector<Vec3> p;
  for (std::size_t i = 0; i < n; ++i) p.emplace_back(double(i), i % 2 == 0 ? 0 : 1, double(i * i) / 10);
  return p;
}

constexpr double kFloatWeights = 1e-6;  // weights are floats: a few ulp of values below 10

TEST(Usd, BsplinesAreSampledOnTheCurve) {
  const std::vector<Vec3> p = zigzag(7);
  const auto taps = curveTaps(curveKind("cubic", "bspline", "nonperiodic"), 7);
  ASSERT_EQ(taps.size(), 9u);  // 4 segments, 2 points each, and the end
  for (std::size_t i = 0; i < taps.size(); ++i) {
    const std::size_t segment = std::min<std::size_t>(i / 2, 3);
    const Vec3 expected = deBoor(p, segment, double(i) / 2 - double(segment));
    EXPECT_LT((tapPoint(taps[i], p) - expected).norm(), 10 * kFloatWeights);
  }
}

TEST(Usd, PinnedBsplinesHavePhantoms) {
  for (std::size_t n : {2u, 3u, 5u}) {
    const std::vector<Vec3> p = zigzag(n);
    std::vector<Vec3> extended = p;
    extended.insert(extended.begin(), 2 * p[0] - p[1]);
    extended.push_back(2 * p[n - 1] - p[n - 2]);
    const auto taps = curveTaps(curveKind("cubic", "bspline", "pinned"), std::uint32_t(n));
    ASSERT_EQ(taps.size(), 2 * (n - 1) + 1);
    EXPECT_LT((tapPoint(taps.front(), p) - p.front()).norm(), kFloatWeights);
    EXPECT_LT((tapPoint(taps.back(), p) - p.back()).norm(), 10 * kFloatWeights);
    for (std::size_t i = 0; i < taps.size(); ++i) {
      const std::size_t segment = std::min(i / 2, n - 2);
      EXPECT_LT((tapPoint(taps[i], p) - deBoor(extended, segment, double(i) / 2 - double(segment))).norm(),
                10 * kFloatWeights);
    }
  }
}

TEST(Usd, BeziersAreSampledOnTheCurve) {
  const std::vector<Vec3> p = zigzag(7);
  const auto taps = curveTaps(curveKind("cubic", "bezier", "nonperiodic"), 7);
  ASSERT_EQ(taps.size(), 7u);
  for (std::size_t i = 0; i < taps.size(); ++i) {
    const std::size_t segment = std::min<std::size_t>(i / 3, 1);
    const double t = double(i) / 3 - double(segment);
    Vec3 d[4];
    for (std::size_t k = 0; k < 4; ++k) d[k] = p[3 * segment + k];
    for (int r = 1; r < 4; ++r) {
      for (int k = 0; k + r < 4; ++k) d[k] = (1 - t) * d[k] + t * d[k + 1];  // de Casteljau
    }
    EXPECT_LT((tapPoint(taps[i], p) - d[0]).norm(), 10 * kFloatWeights);
  }
}

TEST(Usd, EveryTapIsAnAverage) {
  for (const char* type : {"linear", "cubic"}) {
    for (const char* basis : {"bezier", "bspline", "catmullRom"}) {
      for (const char* wrap : {"nonperiodic", "periodic", "pinned"}) {
        for (std::uint32_t n = 0; n < 14; ++n) {
          const auto taps = curveTaps(curveKind(type, basis, wrap), n);
          for (const auto& tap : taps) {
            EXPECT_NEAR(tapSum(tap), 1, kFloatWeights);
            for (const std::uint32_t v : tap.vertex) EXPECT_LT(v, n);
          }
          if (!taps.empty() && std::string_view(wrap) == "periodic") {
            const std::vector<Vec3> p = zigzag(n);
            EXPECT_LT((tapPoint(taps.front(), p) - tapPoint(taps.back(), p)).norm(), 20 * kFloatWeights);
          }
        }
      }
    }
  }
}

constexpr std::string_view kVaryingCurves = R"(#usda 1.0
def BasisCurves "c" {
  uniform token type = "cubic"
  uniform token basis = "bezier"
  int[] curveVertexCounts = [4, 7, 2]
  point3f[] points = [(0,0,0),(1,0,0),(2,0,0),(3,0,0), (0,1,0),(1,1,0),(2,1,0),(3,1,0),(4,1,0),(5,1,0),(6,1,0), (0,0,0),(1,0,0)]
  float[] widths = [1, 4, 1, 4, 10] ( interpolation = "varying" )
  color3f[] primvars:displayColor = [(1,0,0), (0,1,0), (0,0,1)] ( interpolation = "uniform" )
  int[] primvars:groom_id = [7, 8, 9] ( interpolation = "uniform" )
  texCoord2f[] primvars:st = [(0.5, 0.25), (1, 0)] ( interpolation = "uniform" )
  int[] primvars:st:indices = [1, 0, 1]
}
)";

TEST(Usd, ReadsEveryInterpolation) {
  const StrandSet set = strandsOf(kVaryingCurves);
  ASSERT_EQ(set.strandCount(), 2u);  // the third is too short for a Bezier
  EXPECT_EQ(set.widths, (std::vector<float>{1, 2, 3, 4, 1, 2, 3, 4, 6, 8, 10}));
  EXPECT_EQ(set.colors[3], Vec3f(1, 0, 0));
  EXPECT_EQ(set.colors[4], Vec3f(0, 1, 0));
  EXPECT_EQ(set.ids, (std::vector<std::uint64_t>{7, 8}));
  EXPECT_EQ(set.rootUvs[0], Vec2f(1, 0));
  EXPECT_EQ(set.rootUvs[1], Vec2f(0.5f, 0.25f));
  EXPECT_NE(set.information.find("1 curves have too few vertices"), std::string::npos);
  EXPECT_NE(set.information.find("three points a segment"), std::string::npos);
}

// Text.

constexpr std::string_view kManyThings = R"(#usda 1.0
(
    "A comment, with a \" inside"
    customLayerData = { string a = "}" dictionary b = { int c = 1 } }
    metersPerUnit = 1
    subLayers = [@./a.usda@, @@@b@c.usda@@@ (offset = 1; scale = 2)]
    upAxis = "Z"
)

over "Ignored" { def Mesh "m" { point3f[] points = [(0,0,0)] } }
class Mesh "AlsoIgnored" { }
def Xform "A" (
    prepend apiSchemas = ["X"]
    prepend references = @x.usda@</Y> (offset = 3)
    assetInfo = { asset identifier = @y.usda@ }
    variants = { string v = "on" }
    add variantSets = "v"
    active = true
)
{
    reorder nameChildren = ["M"]
    double3 xformOp:translate = (10, 0, 0)
    float xformOp:rotateZ:turn = 90
    float3 xformOp:scale.timeSamples = { 0: (2, 2, 2), 1: (3, 3, 3), }
    uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateZ:turn", "xformOp:scale"]
    variantSet "v" = { "on" ( "}" ) { def Mesh "hidden" { } } "off" { } }
    def Mesh "M" (doc = """three " lines
 }""") {
        uniform token orientation = "leftHanded"
        int[] faceVertexCounts = [4, 2, 3]   # a comment ]
        int[] faceVertexIndices = [0, 1, 2, 3, 0, 1, 0, 2, 3]
        point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1e0, -0)]; bool doubleSided = true
        uniform token subdivisionScheme = "none"
        texCoord2f[] primvars:UVMap = [(0, 0), (1, 0), (1, 1), (0, 1)] (interpolation = "vertex")
        custom asset tex = @a]b.png@
        rel material:binding = [</A/M>, </B>]
        delete rel proxyPrim = </C>
        token outputs:x.connect = </A.b>
        string s = 'single "quoted" }'
        matrix4d m = ( (1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1) )
        double nothing = None
        unknownType[] strange = [<a>, (1, {2})]
        def GeomSubset "Lips" { uniform token elementType = "face"
            int[] indices = [2] }
    }
}
)";

TEST(Usd, ReadsRealText) {
  const PolygonMesh mesh = meshOf(kManyThings);
  EXPECT_EQ(mesh.metersPerUnit, 1);
  EXPECT_EQ(mesh.upAxis, UpAxis::Z);
  ASSERT_EQ(mesh.faceCount(), 2u);  // the two-corner face is left out
  // Left-handed: the winding turns round.
  EXPECT_EQ(mesh.corners, (std::vector<std::uint32_t>{3, 2, 1, 0, 3, 2, 0}));
  // Scaled by 2, turned by 90 degrees about z, moved by 10.
  EXPECT_LT((mesh.positions[1] - Vec3(10, 2, 0)).norm(), 1e-14);
  EXPECT_LT((mesh.positions[2] - Vec3(8, 2, 0)).norm(), 1e-14);
  EXPECT_EQ(mesh.cornerUvs[0], Vec2(0, 1));
  EXPECT_EQ(mesh.groupNames, (std::vector<std::string>{"Lips", "M"}));
  EXPECT_EQ(mesh.faceGroups, (std::vector<std::uint32_t>{1, 0}));
  std::string notes;
  for (const std::string& note : mesh.notes) notes += note + "\n";
  for (const char* word : {"References", "Sublayers", "Variants", "overrides", "fewer than three"}) {
    EXPECT_NE(notes.find(word), std::string::npos) << word << " in\n" << notes;
  }
}

std::string nested(int depth) {
  std::string text = "#usda 1.0\n";
  for (int i = 0; i < depth; ++i) text += "def Xform \"x\" {\n";
  text += "def BasisCurves \"c\" { }";
  for (int i = 0; i < depth; ++i) text += "}";
  return text;
}

TEST(Usd, SaysWhereTextIsWrong) {
  struct Case {
    const char* text;
    const char* place;
  };
  const Case cases[] = {
      {"", "line 1"},
      {"#usda 1.0\nhello \"x\" {}", "line 2"},
      {"#usda 1.0\ndef X \"x\" {\n\n int[] a = [1, z]\n}", "line 4"},
      {"#usda 1.0\ndef X \"x\" {\n point3f[] a = [(1, 2)]\n}", "line 3"},
      {"#usda 1.0\ndef X \"x\" {\n point3f[] a = [1, 2, 3]\n}", "line 3"},
      {"#usda 1.0\ndef X \"x\" {\n string a = \"open\n}", "line 3"},
      {"#usda 1.0\ndef X \"x\" {\n int a = 99999999999\n}", "line 3"},
      {"#usda 1.0\ndef X \"x\" {\n dictionary a = {{{\n}", "line 4"},
      {"#usda 1.0\n(\n metersPerUnit = [[[", "line 3"},
  };
  for (const Case& c : cases) {
    const Error error = strandError(c.text);
    EXPECT_EQ(error.code, ErrorCode::Malformed) << c.text;
    EXPECT_EQ(error.place, c.place) << c.text << error.text();
  }
  EXPECT_EQ(strandError(nested(100000)).code, ErrorCode::Unsupported);
  EXPECT_EQ(strandError("#usda 1.0\n" + std::string(1000000, '(')).code, ErrorCode::Malformed);
  EXPECT_EQ(strandError("PK\x03\x04 zip").code, ErrorCode::Unsupported);
  EXPECT_EQ(strandError("#usda 1.0\ndef BasisCurves \"c\" {}").code, ErrorCode::Degenerate);
  EXPECT_EQ(strandError("#usda 1.0\ndef Mesh \"m\" {}").code, ErrorCode::Unsupported);
}

TEST(Usd, RefusesMeshesThatDoNotAddUp) {
  auto errorOf = [](std::string_view body) {
    const std::string text = "#usda 1.0\ndef Mesh \"m\" {" + std::string(body) + "}";
    const auto mesh = io::readUsdMesh(bytesOf(text), "test.usda");
    EXPECT_FALSE(mesh.ok());
    return mesh.ok() ? Error() : mesh.error();
  };
  const std::string points = "point3f[] points = [(0,0,0),(1,0,0),(0,1,0)]\n";
  EXPECT_EQ(errorOf(points + "int[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0,1]").code,
            ErrorCode::Malformed);
  EXPECT_EQ(errorOf(points + "int[] faceVertexCounts = [-1]\nint[] faceVertexIndices = []").code,
            ErrorCode::Malformed);
  const Error range = errorOf(points + "int[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0,1,3]");
  EXPECT_EQ(range.place, "/m corner 2");
  EXPECT_EQ(errorOf("point3f[] points = [(0,0,nan),(1,0,0),(0,1,0)]\nint[] faceVertexCounts = [3]\n"
                    "int[] faceVertexIndices = [0,1,2]")
                .code,
            ErrorCode::Degenerate);
}

// OpenUSD's own test layers.

fs::path layerPath(const char* name) {
  return fs::path(COIF_SHARED_DATA) / "usd" / name;
}

StrandSet readLayerFile(const char* name) {
  const auto strands = io::readUsdStrands(readFile(layerPath(name)).value(), name);
  EXPECT_TRUE(strands.ok()) << strands.error().text();
  return strands.ok() ? *strands : StrandSet();
}

TEST(Usd, ReadsOpenUsdsTestLayers) {
  if (!fs::exists(layerPath(""))) GTEST_SKIP() << "no shared data";
  const StrandSet bezier = readLayerFile("testUsdGeomBasisCurves__basisCurves.usda");
  EXPECT_EQ(bezier.strandCount(), 2u);  // five vertices: the fifth is surplus
  EXPECT_NE(bezier.information.find("surplus"), std::string::npos);
  EXPECT_EQ(bezier.widths, std::vector<float>(8, 14.700007f));
  EXPECT_EQ(bezier.points[0], Vec3f(-33.5366f, -7.71375f, -5.76872e-13f));

  const StrandSet mixed = readLayerFile("testUsdImagingGLCurves__basicCurves.usda");
  EXPECT_EQ(mixed.strandCount(), 6u);  // of seven, BezierClosedBad cannot be
  EXPECT_NE(mixed.information.find("BezierClosedBad"), std::string::npos);
  EXPECT_EQ(mixed.groupNames[4], "LinearOpen");
  EXPECT_EQ(mixed.strand(4).size(), 4u);
  EXPECT_EQ(mixed.strand(4)[1], Vec3f(-3, 0, -1.5f));  // moved by (-2, 0, -1)
  EXPECT_EQ(mixed.strand(5).size(), 5u);               // closed
  EXPECT_EQ(mixed.strand(5).front(), mixed.strand(5).back());
  EXPECT_EQ(mixed.upAxis, UpAxis::Z);

  const StrandSet pinned = readLayerFile("testUsdImagingGLCurves__pinnedCurves.usda");
  ASSERT_EQ(pinned.strandCount(), 3u);  // the one-vertex curve is left out
  EXPECT_EQ(pinned.strand(0).size(), 9u);
  EXPECT_LT((pinned.strand(0)[0] - Vec3f(1, 0, 0)).norm(), 1e-6f);
  EXPECT_LT((pinned.strand(2)[1] - Vec3f(1.5f, -6, 0)).norm(), 1e-6f);
  EXPECT_EQ(pinned.colors[0], Vec3f(0.7f, 0, 0));
  EXPECT_EQ(pinned.colors.back(), Vec3f(0.7f, 0, 0.7f));

  const StrandSet many = readLayerFile("basicDrawing__BasisCurves2.usda");
  EXPECT_EQ(many.strandCount(), 451u);
  EXPECT_EQ(many.widths.size(), many.pointCount());
  EXPECT_TRUE(validate(many).ok());
}

// Files that usd-core wrote: tests/python/test_usd.py makes them and judges what this test dumps.

template <class T>
void dump(const fs::path& path, const std::vector<T>& values) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(values.data()), std::streamsize(values.size() * sizeof(T)));
}

TEST(Usd, ReadsWhatOpenUsdWrites) {
  const char* folder = std::getenv("COIF_TEST_IN");
  if (folder == nullptr) GTEST_SKIP() << "run by tests/python/test_usd.py";
  int count = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().string();
    if (!entry.path().extension().string().starts_with(".usd")) continue;
    ++count;
    const std::vector<std::byte> bytes = readFile(entry.path()).value();
    if (const auto mesh = io::readUsdMesh(bytes, entry.path()); mesh.ok()) {
      dump(name + ".positions.bin", mesh->positions);
      dump(name + ".faceOffsets.bin", mesh->faceOffsets);
      dump(name + ".corners.bin", mesh->corners);
      dump(name + ".uvs.bin", mesh->cornerUvs);
    } else {
      std::ofstream(name + ".meshError.txt") << mesh.error().text();
    }
    if (const auto strands = io::readUsdStrands(bytes, entry.path()); strands.ok()) {
      dump(name + ".offsets.bin", strands->offsets);
      dump(name + ".points.bin", strands->points);
      dump(name + ".widths.bin", strands->widths);
      dump(name + ".ids.bin", strands->ids);
    } else {
      std::ofstream(name + ".strandError.txt") << strands.error().text();
    }
  }
  EXPECT_GT(count, 0);
}

}  // namespace
}  // namespace coif
