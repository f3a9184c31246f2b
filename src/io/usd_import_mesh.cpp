// Meshes out of a USD layer.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "formats.h"
#include "usd_walk.h"

namespace coif::io {
namespace {

using namespace usd;

/// What a Mesh prim says, before it joins the others.
struct Source {
  std::vector<float> points;
  std::vector<std::int64_t> counts, corners;
  std::vector<float> uvs;
  std::string_view uvInterpolation;
};

class MeshImport {
 public:
  explicit MeshImport(MemoryBudget& budget) : budget_(budget) {}

  Status add(const Placed& placed) {
    auto status = tryAdd(placed);
    if (status) return {};
    Error error = status.error();
    error.place = placed.path + (error.place.empty() ? "" : " " + error.place);
    return error;
  }

  PolygonMesh finish() {
    if (withUvs_ == 0) mesh_.cornerUvs.clear();
    if (withUvs_ > 0 && withoutUvs_ > 0) {
      mesh_.notes.push_back(std::to_string(withoutUvs_) + " meshes have no UVs; theirs are (0, 0).");
    }
    noteCount(mesh_, thin_, "faces of fewer than three corners are left out.");
    noteCount(mesh_, subdivided_, "meshes are subdivision surfaces; their cages are read.");
    return std::move(mesh_);
  }

 private:
  Status tryAdd(const Placed& placed) {
    const Prim& prim = *placed.prim;
    COIF_ASSIGN(const Source source, read(prim));
    const std::size_t points = source.points.size() / 3;
    COIF_TRY(budget_.take(points, sizeof(Vec3)));
    COIF_TRY(budget_.take(source.corners.size(), sizeof(std::uint32_t) + sizeof(Vec2)));
    COIF_TRY(budget_.take(source.counts.size(), 4 * sizeof(std::uint32_t)));
    if (mesh_.positions.size() + points >= kNone || mesh_.corners.size() + source.corners.size() >= kNone) {
      return makeError(ErrorCode::TooLarge, "the meshes have more than 2^32 corners");
    }
    const std::size_t firstVertex = mesh_.positions.size();
    for (std::size_t i = 0; i < points; ++i) {
      const Eigen::Vector4d p(source.points[3 * i], source.points[3 * i + 1], source.points[3 * i + 2], 1);
      mesh_.positions.push_back((placed.worldFromPrim * p).head<3>());
      if (!mesh_.positions.back().allFinite()) {
        return makeError(ErrorCode::Degenerate, "the point is not finite", "point " + std::to_string(i));
      }
    }
    const Value* orientation = prim.value("orientation");
    const bool leftHanded = orientation != nullptr && orientation->text() == "leftHanded";
    const bool mirrored = placed.worldFromPrim.topLeftCorner<3, 3>().determinant() < 0;
    addFaces(source, firstVertex, leftHanded != mirrored, faceGroups(prim, source.counts.size()));
    const Value* scheme = prim.value("subdivisionScheme");
    if (scheme == nullptr || scheme->text() != "none") ++subdivided_;
    return {};
  }

  Result<Source> read(const Prim& prim) {
    Source source;
    const Value* points = prim.value("points");
    const Value* counts = prim.value("faceVertexCounts");
    const Value* corners = prim.value("faceVertexIndices");
    if (points == nullptr || counts == nullptr || corners == nullptr) return source;
    if (points->type.components != 3) return makeError(ErrorCode::Malformed, "points are not triples");
    for (const Value* value : {points, counts, corners}) {
      COIF_TRY(budget_.take(value->array.count * value->type.components, sizeof(std::int64_t)));
    }
    source.points = numbers<float>(*points);
    source.counts = numbers<std::int64_t>(*counts);
    source.corners = numbers<std::int64_t>(*corners);
    std::uint64_t left = source.corners.size();
    for (const std::int64_t count : source.counts) {
      if (count < 0 || std::uint64_t(count) > left) {
        return makeError(ErrorCode::Malformed, "faceVertexCounts do not add up to faceVertexIndices");
      }
      left -= std::uint64_t(count);
    }
    if (left > 0)
      return makeError(ErrorCode::Malformed, "faceVertexCounts do not add up to faceVertexIndices");
    const auto vertices = std::int64_t(source.points.size() / 3);
    for (std::size_t c = 0; c < source.corners.size(); ++c) {
      if (source.corners[c] < 0 || source.corners[c] >= vertices) {
        return makeError(ErrorCode::Malformed, "a vertex index is out of range",
                         "corner " + std::to_string(c));
      }
    }
    COIF_TRY(readUvs(prim, vertices, source));
    return source;
  }

  /// primvars:st or, without it, the first primvar of texture coordinates.
  Status readUvs(const Prim& prim, std::int64_t vertices, Source& source) {
    std::string name = "primvars:st";
    if (prim.value(name) == nullptr) {
      for (const Attribute& a : prim.attributes) {
        if (a.name.starts_with("primvars:") && a.typeName.starts_with("texCoord2") && a.value) name = a.name;
      }
    }
    for (const std::string& part : {name, name + ":indices"}) {
      const Value* value = prim.value(part);
      if (value != nullptr) COIF_TRY(budget_.take(value->array.count, 2 * sizeof(double)));
    }
    source.uvs = primvarNumbers(prim, name, 2);
    source.uvInterpolation = interpolationOf(prim, name);
    const std::size_t count = source.uvs.size() / 2;
    const bool perCorner = source.uvInterpolation == "faceVarying" && count == source.corners.size();
    const bool perVertex = (source.uvInterpolation == "vertex" || source.uvInterpolation == "varying") &&
                           std::int64_t(count) == vertices;
    const bool finite =
        std::all_of(source.uvs.begin(), source.uvs.end(), [](float x) { return std::isfinite(x); });
    if (!finite || (!perCorner && !perVertex)) source.uvs.clear();
    return {};
  }

  void addFaces(const Source& source, std::size_t firstVertex, bool flip,
                const std::vector<std::uint32_t>& groups) {
    (source.uvs.empty() ? withoutUvs_ : withUvs_) += source.counts.empty() ? 0 : 1;
    std::size_t first = 0;
    for (std::size_t f = 0; f < source.counts.size(); ++f) {
      const auto size = std::size_t(source.counts[f]);
      if (size < 3) {
        ++thin_;
      } else {
        for (std::size_t i = 0; i < size; ++i)
          addCorner(source, first + (flip ? size - 1 - i : i), firstVertex);
        closeFace(mesh_);
        mesh_.faceGroups.push_back(groups[f]);
      }
      first += size;
    }
  }

  void addCorner(const Source& source, std::size_t corner, std::size_t firstVertex) {
    const auto vertex = std::size_t(source.corners[corner]);
    mesh_.corners.push_back(std::uint32_t(firstVertex + vertex));
    Vec2 uv = Vec2::Zero();
    if (!source.uvs.empty()) {
      const std::size_t at = source.uvInterpolation == "faceVarying" ? corner : vertex;
      uv = Vec2(source.uvs[2 * at], source.uvs[2 * at + 1]);
    }
    mesh_.cornerUvs.push_back(uv);
  }

  /// The subset a face is in (the last one that names it), else the mesh's own name.
  std::vector<std::uint32_t> faceGroups(const Prim& prim, std::size_t faces) {
    std::vector<std::uint32_t> groups(faces, kNone);
    for (const Prim& child : prim.children) {
      if (child.typeName != "GeomSubset") continue;
      const Value* element = child.value("elementType");
      const Value* indices = child.value("indices");
      if (indices == nullptr || (element != nullptr && element->text() != "face")) continue;
      const std::uint32_t group = groupIndex(shownName(child));
      for (const std::int64_t f : numbers<std::int64_t>(*indices)) {
        if (f >= 0 && std::size_t(f) < faces) groups[std::size_t(f)] = group;
      }
    }
    for (std::uint32_t& group : groups) {
      if (group == kNone) group = groupIndex(shownName(prim));
    }
    return groups;
  }

  static std::string shownName(const Prim& prim) {
    const Value* name = find(prim.metadata, "displayName");
    return name != nullptr && !name->text().empty() ? std::string(name->text()) : prim.name;
  }

  std::uint32_t groupIndex(const std::string& name) {
    const auto [at, isNew] = groups_.emplace(name, std::uint32_t(mesh_.groupNames.size()));
    if (isNew) mesh_.groupNames.push_back(name);
    return at->second;
  }

  MemoryBudget& budget_;
  PolygonMesh mesh_;
  std::unordered_map<std::string, std::uint32_t> groups_;
  std::size_t withUvs_ = 0, withoutUvs_ = 0, thin_ = 0, subdivided_ = 0;
};

/// Guides and proxies stand for something else: read only when there is nothing else.
void dropHelpers(std::vector<Placed>& meshes, std::vector<std::string>& notes) {
  const auto helpers = std::count_if(meshes.begin(), meshes.end(), [](const Placed& m) { return m.helper; });
  if (helpers == 0 || std::size_t(helpers) == meshes.size()) return;
  std::erase_if(meshes, [](const Placed& m) { return m.helper; });
  notes.push_back(std::to_string(helpers) + " meshes of purpose guide or proxy are left out.");
}

}  // namespace

Result<std::vector<Placed>> usd::meshesOf(const Layer& layer, MemoryBudget& budget,
                                          std::vector<std::string>& notes) {
  COIF_ASSIGN(std::vector<Placed> meshes, placedPrims(layer, "Mesh", budget, notes));
  if (meshes.empty()) return makeError(ErrorCode::Unsupported, "the file holds no Mesh prim");
  dropHelpers(meshes, notes);
  return meshes;
}

std::size_t usd::vertexCountOf(const Prim& mesh) {
  for (const char* needed : {"points", "faceVertexCounts", "faceVertexIndices"}) {
    if (mesh.value(needed) == nullptr) return 0;
  }
  return std::size_t(mesh.value("points")->array.count);
}

Result<PolygonMesh> readUsdMesh(Bytes bytes, const std::filesystem::path& path) {
  MemoryBudget budget(bytes.size());
  auto read = [&]() -> Result<PolygonMesh> {
    COIF_ASSIGN(const Layer layer, readLayer(bytes, budget));
    std::vector<std::string> notes = layer.notes;
    COIF_ASSIGN(const std::vector<Placed> meshes, usd::meshesOf(layer, budget, notes));
    MeshImport import(budget);
    for (const Placed& placed : meshes) COIF_TRY(import.add(placed));
    PolygonMesh mesh = import.finish();
    if (mesh.faceCount() == 0) return makeError(ErrorCode::Degenerate, "the file holds no polygon");
    mesh.metersPerUnit = metersPerUnit(layer, 0);
    mesh.upAxis = upAxis(layer);
    mesh.notes.insert(mesh.notes.begin(), notes.begin(), notes.end());
    return mesh;
  };
  auto mesh = read();
  if (!mesh) return inFile(mesh.error(), path.string());
  return mesh;
}

}  // namespace coif::io
