// Strands as glTF 2.0, which has no strands: indexed LINES, one primitive a group, over shared points.
//
// Every vertex carries _RADIUS, _ROOT_UV and _STRAND_ID (the strand's index: float, since glTF forbids 32-bit
// integers in vertex attributes; exact up to 2^24 strands). What is per strand and must come back exactly
// (lengths, 64-bit ids, groups, root faces, weights) lies in one buffer view that asset.extras.coif
// describes: see gltf_strands.cpp.
#include <algorithm>
#include <cmath>

#include "io/gltf_builder.h"
#include "io/gltf_shapes.h"
#include "io/gltf_strand_table.h"

namespace coif::io {
namespace {

using Json = GltfBuilder::Json;
using Sink = GltfBuilder::Sink;

class GltfWriter {
 public:
  explicit GltfWriter(const StrandExport& what) : what_(what), set_(*what.strands) {}
  Result<WriteReport> write(const std::filesystem::path& path, const Context& context);

 private:
  void describeScene();
  int addMaterial(const char* name, const Vec3f& color);
  Json pointAttributes();
  void addStrands();
  void addGroup(const std::string& name, std::span<const std::uint32_t> strands, const Json& attributes,
                int material);
  void addTable(int mesh);
  void addTriangles(const char* name, const TriangleMesh& mesh, int material, const char* role);
  void addNode(const std::string& name, const char* role);
  Status addShapes();

  const StrandExport& what_;
  const StrandSet& set_;
  GltfBuilder builder_;
  WriteReport report_;
  std::vector<std::uint32_t> strandsByGroup_;
  TriangleMesh fallback_, hairMesh_, head_;  // they outlive the write
};

/// Points stay as they are; the root node says how they lie in glTF's metres and y-up.
void GltfWriter::describeScene() {
  Json& json = builder_.json;
  json["asset"] = {{"version", "2.0"}, {"generator", what_.creator}};
  json["scene"] = 0;
  json["scenes"] = {{{"nodes", {0}}}};
  Json root{{"name", "Coif"}};
  if (set_.metersPerUnit != 1) root["scale"] = {set_.metersPerUnit, set_.metersPerUnit, set_.metersPerUnit};
  const double half = std::sqrt(0.5);
  if (set_.upAxis == UpAxis::Z)
    root["rotation"] = {-half, 0, 0, half};  // a quarter turn about x: z becomes y
  json["nodes"].push_back(root);
}

int GltfWriter::addMaterial(const char* name, const Vec3f& color) {
  Json& materials = builder_.json["materials"];
  const Vec3f c = color.cwiseMax(0.0f).cwiseMin(1.0f);
  materials.push_back(
      {{"name", name},
       {"doubleSided", true},
       {"pbrMetallicRoughness",
        {{"baseColorFactor", {c.x(), c.y(), c.z(), 1}}, {"metallicFactor", 0}, {"roughnessFactor", 0.5}}}});
  return int(materials.size()) - 1;
}

void GltfWriter::addNode(const std::string& name, const char* role) {
  Json& nodes = builder_.json["nodes"];
  nodes[0]["children"].push_back(nodes.size());
  nodes.push_back(
      {{"name", name}, {"mesh", builder_.json["meshes"].size() - 1}, {"extras", {{"coif", role}}}});
}

Json GltfWriter::pointAttributes() {
  Json attributes;
  const std::uint64_t points = set_.pointCount();
  attributes["POSITION"] = builder_.addVectors("points", std::span<const Vec3f>(set_.points), true);
  if (!set_.widths.empty()) {
    attributes["_RADIUS"] = builder_.addFloats("radii", points, 1, [this](const Sink& sink) {
      streamValues<float>(sink, set_.pointCount(), [this](std::uint64_t p) { return 0.5f * set_.widths[p]; });
    });
  }
  // A cursor over strands: points are asked for in order.
  const auto perStrand = [this](auto valueOf) {
    return [this, valueOf, s = std::size_t{0}](std::uint64_t p) mutable {
      while (set_.offsets[s + 1] <= p) ++s;
      return valueOf(s);
    };
  };
  if (!set_.rootUvs.empty()) {
    attributes["_ROOT_UV"] = builder_.addFloats("root UVs", points, 2, [this, perStrand](const Sink& sink) {
      streamValues<Vec2f>(sink, set_.pointCount(),
                          perStrand([this](std::size_t s) { return set_.rootUvs[s]; }));
    });
  }
  attributes["_STRAND_ID"] =
      builder_.addFloats("strand indices", points, 1, [this, perStrand](const Sink& sink) {
        streamValues<float>(sink, set_.pointCount(), perStrand([](std::size_t s) { return float(s); }));
      });
  if (!set_.colors.empty()) {
    const bool inRange = std::all_of(set_.colors.begin(), set_.colors.end(),
                                     [](const Vec3f& c) { return c.minCoeff() >= 0 && c.maxCoeff() <= 1; });
    if (!inRange)
      report_.notes.push_back("glTF colours end at 1: the strands' colours are in _COLOR instead.");
    attributes[inRange ? "COLOR_0" : "_COLOR"] =
        builder_.addVectors("colours", std::span<const Vec3f>(set_.colors));
  }
  if (!set_.transparencies.empty()) {
    attributes["_TRANSPARENCY"] = builder_.addFloats("transparencies", points, 1, [this](const Sink& sink) {
      sink(std::as_bytes(std::span<const float>(set_.transparencies)));
    });
  }
  return attributes;
}

void GltfWriter::addGroup(const std::string& name, std::span<const std::uint32_t> strands,
                          const Json& attributes, int material) {
  std::uint64_t segments = 0;
  for (const std::uint32_t s : strands) {
    const std::uint64_t points = set_.offsets[s + 1] - set_.offsets[s];
    segments += points > 0 ? points - 1 : 0;
  }
  if (segments == 0) return;
  const int indices = builder_.addIndices("segments", 2 * segments, [this, strands](const Sink& sink) {
    std::vector<std::uint32_t> ends;
    for (const std::uint32_t s : strands) {
      ends.clear();
      for (std::uint64_t p = set_.offsets[s]; p + 1 < set_.offsets[s + 1]; ++p) {
        ends.insert(ends.end(), {std::uint32_t(p), std::uint32_t(p + 1)});
      }
      sink(std::as_bytes(std::span<const std::uint32_t>(ends)));
    }
  });
  constexpr int kLines = 1;
  builder_.json["meshes"].push_back(
      {{"name", name},
       {"primitives",
        {{{"attributes", attributes}, {"indices", indices}, {"material", material}, {"mode", kLines}}}}});
  addNode(name, "strands");
}

/// Strands in the order of their groups, stable within each.
void GltfWriter::addStrands() {
  const bool grouped = !set_.groups.empty();
  const std::size_t groups = grouped ? set_.groupNames.size() : 1;
  std::vector<std::size_t> begin(groups + 1, 0);
  for (std::size_t s = 0; s < set_.strandCount(); ++s) ++begin[(grouped ? set_.groups[s] : 0) + 1];
  for (std::size_t g = 0; g < groups; ++g) begin[g + 1] += begin[g];
  strandsByGroup_.resize(set_.strandCount());
  std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
  for (std::size_t s = 0; s < set_.strandCount(); ++s) {
    strandsByGroup_[next[grouped ? set_.groups[s] : 0]++] = std::uint32_t(s);
  }
  const Json attributes = pointAttributes();
  const int material = addMaterial("hair", what_.color);
  for (std::size_t g = 0; g < groups; ++g) {
    addGroup(grouped ? set_.groupNames[g] : "strands",
             std::span<const std::uint32_t>(strandsByGroup_).subspan(begin[g], begin[g + 1] - begin[g]),
             attributes, material);
  }
  addTable(0);
}

void GltfWriter::addTable(int mesh) {
  Json description = describeStrandTable(set_);
  const std::uint64_t bytes = strandTableBytes(set_);
  description["bufferView"] = builder_.addView("coif strand table", bytes, GltfTarget::None,
                                               [this](const Sink& sink) { writeStrandTable(set_, sink); });
  description["mesh"] = mesh;
  builder_.json["asset"]["extras"] = {{"coif", description}};
}

void GltfWriter::addTriangles(const char* name, const TriangleMesh& mesh, int material, const char* role) {
  if (mesh.indices.empty()) return;
  Json attributes;
  attributes["POSITION"] = builder_.addVectors(name, std::span<const Vec3f>(mesh.positions), true);
  attributes["NORMAL"] = builder_.addVectors(name, std::span<const Vec3f>(mesh.normals));
  if (!mesh.uvs.empty())
    attributes["TEXCOORD_0"] = builder_.addVectors(name, std::span<const Vec2f>(mesh.uvs));
  const int indices = builder_.addIndices(name, mesh.indices.size(), [&mesh](const Sink& sink) {
    sink(std::as_bytes(std::span<const std::uint32_t>(mesh.indices)));
  });
  builder_.json["meshes"].push_back(
      {{"name", name},
       {"primitives", {{{"attributes", attributes}, {"indices", indices}, {"material", material}}}}});
  addNode(name, role);
}

Status GltfWriter::addShapes() {
  const std::size_t shown = std::min(what_.meshStrandLimit, set_.strandCount());
  if (what_.mesh != StrandMesh::None && shown > 0) {
    fallback_ = strandShapes(set_, what_.mesh, shown);
    addTriangles(what_.mesh == StrandMesh::Cards ? "hair cards" : "hair tubes", fallback_, 0, "fallback");
    report_.notes.push_back("The mesh for viewers without lines shows " + std::to_string(shown) + " of " +
                            std::to_string(set_.strandCount()) + " strands, widened.");
  }
  if (what_.hairMesh != nullptr && !what_.hairMesh->bundles().empty()) {
    COIF_ASSIGN(hairMesh_, trianglesOf(outsideOf(*what_.hairMesh)));
    addTriangles("hair mesh", hairMesh_, addMaterial("hair mesh", Vec3f(0.2f, 0.4f, 0.8f)), "hair mesh");
    report_.notes.push_back("glTF shows the outside of the hair mesh as triangles; its layers are left out.");
  }
  if (what_.head != nullptr && what_.head->faceCount() > 0) {
    COIF_ASSIGN(head_, trianglesOf(*what_.head));
    addTriangles("head", head_, addMaterial("head", Vec3f(0.8f, 0.6f, 0.5f)), "head");
  }
  return {};
}

Result<WriteReport> GltfWriter::write(const std::filesystem::path& path, const Context& context) {
  constexpr std::uint64_t kMaxPoints = 0xfffffffeu;  // the greatest index is kept for primitive restart
  if (set_.pointCount() > kMaxPoints)
    return makeError(ErrorCode::TooLarge, "glTF counts points in 32 bits", {}, path.string());
  const bool anySegment =
      std::adjacent_find(set_.offsets.begin(), set_.offsets.end(),
                         [](std::uint64_t a, std::uint64_t b) { return b - a > 1; }) != set_.offsets.end();
  if (!anySegment)
    return makeError(ErrorCode::InvalidArgument, "no strand has two points", {}, path.string());
  if (set_.strandCount() > (std::size_t{1} << 24)) {
    report_.notes.push_back(
        "_STRAND_ID is a float and rounds beyond 2^24 strands; the strand table is exact.");
  }
  if (!what_.frames.empty()) report_.notes.push_back("glTF has no place for the animation of single points.");
  describeScene();
  addStrands();
  const Status shapes = addShapes();
  if (!shapes.ok()) return inFile(shapes.error(), path.string());
  COIF_ASSIGN(report_.bytes, builder_.write(path, context));
  return std::move(report_);
}

}  // namespace

Result<WriteReport> writeGltf(const StrandExport& what, const std::filesystem::path& path,
                              const Context& context) {
  return GltfWriter(what).write(path, context);
}

}  // namespace coif::io
