// Meshes of a glTF scene: every triangle, strip and fan, placed by its nodes.
#include <Eigen/Geometry>
#include <map>

#include "io/gltf_document.h"

namespace coif::io {
namespace {

using Mat4 = Eigen::Matrix4d;

class GltfMeshReader {
 public:
  GltfMeshReader(const GltfDocument& document, MemoryBudget& budget) : document_(document), budget_(budget) {}
  Result<PolygonMesh> read();

 private:
  struct Visit {
    int node;
    Mat4 worldFromParent;
  };
  Result<std::vector<int>> rootNodes();
  Status visitNode(const Visit& visit, std::vector<Visit>& pending);
  Status addMesh(int mesh, const Mat4& worldFromMesh, const std::string& nodeName);
  Status addPrimitive(const tinygltf::Primitive& primitive, const Mat4& worldFromMesh,
                      std::map<int, std::uint32_t>& shared);
  Result<std::uint32_t> addVertices(int accessor, const Mat4& worldFromMesh);
  Status addTriangles(const tinygltf::Primitive& primitive, std::uint32_t base, std::size_t vertexCount,
                      bool flip);
  std::string materialName(int material) const;
  bool isFallback(int node) const;

  const GltfDocument& document_;
  MemoryBudget& budget_;
  PolygonMesh mesh_;
  FaceNames names_;
  std::vector<Vec2f> uvs_;
  bool primitiveHasUvs_ = false;
  std::uint64_t linesAndPoints_ = 0, skinned_ = 0, morphed_ = 0, looseIndices_ = 0, flatIndices_ = 0,
                fallbacks_ = 0, cornersWithout_ = 0;
  std::string place_;
};

Result<Mat4> nodeTransform(const tinygltf::Node& node, const std::string& place) {
  Mat4 m = Mat4::Identity();
  if (node.matrix.size() == 16) {
    m = Eigen::Map<const Mat4>(node.matrix.data());  // column-major, as glTF has it
  } else {
    Eigen::Affine3d trs = Eigen::Affine3d::Identity();
    if (node.translation.size() == 3) trs.translate(Eigen::Map<const Vec3>(node.translation.data()));
    if (node.rotation.size() == 4) {
      const auto& q = node.rotation;
      const Eigen::Quaterniond rotation(q[3], q[0], q[1], q[2]);
      if (!(rotation.norm() > 0)) return makeError(ErrorCode::Malformed, "the rotation has no length", place);
      trs.rotate(rotation.normalized());
    }
    if (node.scale.size() == 3) trs.scale(Eigen::Map<const Vec3>(node.scale.data()));
    m = trs.matrix();
  }
  if (!m.allFinite()) return makeError(ErrorCode::Degenerate, "the transform is not finite", place);
  return m;
}

Result<std::vector<int>> GltfMeshReader::rootNodes() {
  const tinygltf::Model& model = document_.model;
  if (!model.scenes.empty()) {
    const std::size_t scene = model.defaultScene < 0 ? 0 : std::size_t(model.defaultScene);
    if (scene >= model.scenes.size())
      return makeError(ErrorCode::Malformed, "the default scene does not exist");
    if (model.scenes.size() > 1) mesh_.notes.push_back("Only one of several scenes is read.");
    return model.scenes[scene].nodes;
  }
  std::vector<bool> isChild(model.nodes.size(), false);
  for (const tinygltf::Node& node : model.nodes) {
    for (const int child : node.children) {
      if (child >= 0 && std::size_t(child) < isChild.size()) isChild[std::size_t(child)] = true;
    }
  }
  std::vector<int> roots;
  for (std::size_t n = 0; n < isChild.size(); ++n) {
    if (!isChild[n]) roots.push_back(int(n));
  }
  return roots;
}

/// The ribbons or tubes that Coif writes beside strands for viewers without lines: no part of any head.
bool GltfMeshReader::isFallback(int node) const {
  const auto& nodes = document_.json["nodes"];
  const auto& entry = nodes[std::size_t(node)];
  const auto extras = entry.find("extras");
  return extras != entry.end() && extras->is_object() &&
         extras->value("coif", nlohmann::json()) == "fallback";
}

Status GltfMeshReader::visitNode(const Visit& visit, std::vector<Visit>& pending) {
  const tinygltf::Node& node = document_.model.nodes[std::size_t(visit.node)];
  const std::string place = "node " + std::to_string(visit.node);
  COIF_ASSIGN(const Mat4 parentFromNode, nodeTransform(node, place));
  const Mat4 worldFromNode = visit.worldFromParent * parentFromNode;
  if (!worldFromNode.allFinite())
    return makeError(ErrorCode::Degenerate, "the transform is not finite", place);
  // Popped from the back: pushed in reverse, children come in their order.
  for (auto child = node.children.rbegin(); child != node.children.rend(); ++child) {
    pending.push_back({*child, worldFromNode});
  }
  if (node.mesh < 0) return {};
  if (isFallback(visit.node)) return ++fallbacks_, Status();
  // A skinned mesh is placed by its joints alone (glTF 2.0, 3.7.3.3); in the bind pose they leave it where it
  // is.
  if (node.skin >= 0) ++skinned_;
  return addMesh(node.mesh, node.skin >= 0 ? Mat4(Mat4::Identity()) : worldFromNode, node.name);
}

std::string GltfMeshReader::materialName(int material) const {
  const auto materials = document_.json.find("materials");
  if (materials == document_.json.end() || !materials->is_array() ||
      std::size_t(material) >= materials->size()) {
    return "default";
  }
  const auto& entry = (*materials)[std::size_t(material)];
  const auto name = entry.is_object() ? entry.find("name") : entry.end();
  const bool named = entry.is_object() && name != entry.end() && name->is_string();
  return named ? name->get<std::string>() : "material " + std::to_string(material);
}

Status GltfMeshReader::addMesh(int mesh, const Mat4& worldFromMesh, const std::string& nodeName) {
  const tinygltf::Model& model = document_.model;
  if (std::size_t(mesh) >= model.meshes.size())
    return makeError(ErrorCode::Malformed, "a node names a mesh that does not exist");
  const tinygltf::Mesh& source = model.meshes[std::size_t(mesh)];
  const std::string name = !nodeName.empty()      ? nodeName
                           : !source.name.empty() ? source.name
                                                  : "mesh " + std::to_string(mesh);
  COIF_TRY(names_.set(FaceNames::Object, name, mesh_.faceCount(), budget_));
  std::map<int, std::uint32_t> shared;  // primitives of one mesh often share their vertices
  for (std::size_t p = 0; p < source.primitives.size(); ++p) {
    const tinygltf::Primitive& primitive = source.primitives[p];
    place_ = "mesh " + std::to_string(mesh) + ", primitive " + std::to_string(p);
    COIF_TRY(names_.set(FaceNames::Material,
                        primitive.material >= 0 ? materialName(primitive.material) : "default",
                        mesh_.faceCount(), budget_));
    COIF_TRY(addPrimitive(primitive, worldFromMesh, shared));
  }
  return {};
}

Result<std::uint32_t> GltfMeshReader::addVertices(int accessor, const Mat4& worldFromMesh) {
  std::vector<Vec3f> points;
  COIF_TRY(readAccessor(document_, accessor, budget_, points));
  // Many primitives: doubling would hold three times the array, so each gets its exact room from the budget.
  COIF_TRY(budget_.take(3 * points.size(), sizeof(Vec3)));
  const auto base = std::uint32_t(mesh_.positions.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 p = (worldFromMesh * points[i].cast<double>().homogeneous()).head<3>();
    if (!p.allFinite()) {
      return makeError(ErrorCode::Degenerate, "position " + std::to_string(i) + " is not finite", place_);
    }
    mesh_.positions.push_back(p);
  }
  return base;
}

Status GltfMeshReader::addPrimitive(const tinygltf::Primitive& primitive, const Mat4& worldFromMesh,
                                    std::map<int, std::uint32_t>& shared) {
  const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
  if (mode < TINYGLTF_MODE_TRIANGLES) return ++linesAndPoints_, Status();
  if (mode > TINYGLTF_MODE_TRIANGLE_FAN)
    return makeError(ErrorCode::Malformed, "the mode is none of glTF's", place_);
  const auto position = primitive.attributes.find("POSITION");
  if (position == primitive.attributes.end()) {
    if (primitive.extensions.empty()) return {};  // glTF: nothing to show
    return makeError(ErrorCode::Unsupported, "the positions are left to an extension", place_);
  }
  if (!primitive.targets.empty()) ++morphed_;
  COIF_ASSIGN(const std::size_t count, checkAccessor(document_, position->second, 3, false));
  const bool noView = document_.model.accessors[std::size_t(position->second)].bufferView < 0;
  if (noView && primitive.extensions.count("KHR_draco_mesh_compression") > 0) {
    return makeError(ErrorCode::Unsupported, "Draco compression is not read", place_);
  }
  auto base = shared.find(position->second);
  if (base == shared.end()) {
    COIF_ASSIGN(const std::uint32_t first, addVertices(position->second, worldFromMesh));
    base = shared.emplace(position->second, first).first;
  }
  uvs_.clear();
  const auto uv = primitive.attributes.find("TEXCOORD_0");
  primitiveHasUvs_ = uv != primitive.attributes.end();
  if (primitiveHasUvs_) {
    COIF_TRY(readAccessor(document_, uv->second, budget_, uvs_));
    if (uvs_.size() != count)
      return makeError(ErrorCode::Malformed, "TEXCOORD_0 and POSITION differ in length", place_);
  }
  // A mirroring transform turns the triangles' winding (glTF 2.0, 3.7.4).
  return addTriangles(primitive, base->second, count, worldFromMesh.topLeftCorner<3, 3>().determinant() < 0);
}

Status GltfMeshReader::addTriangles(const tinygltf::Primitive& primitive, std::uint32_t base,
                                    std::size_t vertexCount, bool flip) {
  std::vector<std::uint32_t> indices;
  if (primitive.indices >= 0) COIF_TRY(readAccessor(document_, primitive.indices, budget_, indices));
  const std::size_t count = primitive.indices >= 0 ? indices.size() : vertexCount;
  const bool list = primitive.mode < 0 || primitive.mode == TINYGLTF_MODE_TRIANGLES;
  const bool fan = primitive.mode == TINYGLTF_MODE_TRIANGLE_FAN;
  const std::size_t triangles = list ? count / 3 : count < 3 ? 0 : count - 2;
  if (list ? count % 3 != 0 : count < 3) ++looseIndices_;
  COIF_TRY(budget_.take(9 * triangles, sizeof(std::uint32_t) + sizeof(Vec2)));  // growing: up to three times
  for (std::size_t t = 0; t < triangles; ++t) {
    // Strip: (i, i + 1 + i % 2, i + 2 - i % 2); fan: (i + 1, i + 2, 0); as glTF 2.0, 3.7.2.1 has them.
    std::size_t at[3] = {list  ? 3 * t
                         : fan ? t + 1
                               : t,
                         list  ? 3 * t + 1
                         : fan ? t + 2
                               : t + 1 + t % 2,
                         list  ? 3 * t + 2
                         : fan ? 0
                               : t + 2 - t % 2};
    if (flip) std::swap(at[1], at[2]);
    std::uint32_t v[3];
    for (int i = 0; i < 3; ++i) {
      v[i] = primitive.indices >= 0 ? indices[at[i]] : std::uint32_t(at[i]);
      if (v[i] >= vertexCount) {
        return makeError(
            ErrorCode::Malformed,
            "index " + std::to_string(v[i]) + " is beyond the " + std::to_string(vertexCount) + " vertices",
            place_);
      }
    }
    if (v[0] == v[1] || v[1] == v[2] || v[0] == v[2]) {
      if (list) ++flatIndices_;
      continue;  // strips join so
    }
    const bool firstUvs = primitiveHasUvs_ && mesh_.cornerUvs.empty();
    if (firstUvs) mesh_.cornerUvs.assign(mesh_.corners.size(), Vec2(0, 0));
    for (const std::uint32_t vertex : v) {
      mesh_.corners.push_back(base + vertex);
      if (!primitiveHasUvs_) ++cornersWithout_;
      if (mesh_.cornerUvs.empty() && !primitiveHasUvs_) continue;
      // glTF counts v downwards from the image's top, this mesh (as OBJ) upwards from its bottom.
      const Vec2 uv = primitiveHasUvs_ ? Vec2(uvs_[vertex].x(), 1.0 - double(uvs_[vertex].y())) : Vec2(0, 0);
      if (!uv.allFinite())
        return makeError(ErrorCode::Degenerate, "a texture coordinate is not finite", place_);
      mesh_.cornerUvs.push_back(uv);
    }
    closeFace(mesh_);
  }
  return {};
}

Result<PolygonMesh> GltfMeshReader::read() {
  const tinygltf::Model& model = document_.model;
  COIF_ASSIGN(const std::vector<int> roots, rootNodes());
  std::vector<Visit> pending;
  for (auto root = roots.rbegin(); root != roots.rend(); ++root) pending.push_back({*root, Mat4::Identity()});
  std::vector<bool> visited(model.nodes.size(), false);
  while (!pending.empty()) {
    const Visit visit = pending.back();
    pending.pop_back();
    if (visit.node < 0 || std::size_t(visit.node) >= model.nodes.size()) {
      return makeError(ErrorCode::Malformed, "node " + std::to_string(visit.node) + " does not exist");
    }
    if (visited[std::size_t(visit.node)]) {
      return makeError(ErrorCode::Malformed, "the node has two parents or is its own ancestor",
                       "node " + std::to_string(visit.node));
    }
    visited[std::size_t(visit.node)] = true;
    COIF_TRY(visitNode(visit, pending));
  }
  if (model.nodes.empty()) {
    for (std::size_t m = 0; m < model.meshes.size(); ++m) COIF_TRY(addMesh(int(m), Mat4::Identity(), {}));
    if (!model.meshes.empty())
      mesh_.notes.push_back("The file has no nodes; its meshes are taken as they lie.");
  }
  if (mesh_.faceCount() == 0) return makeError(ErrorCode::Degenerate, "the scene holds no triangle");
  COIF_TRY(budget_.take(mesh_.faceCount(), sizeof(std::uint32_t)));
  names_.finish(mesh_, {"materials", "groups", "nodes"});
  mesh_.metersPerUnit = 1;
  if (!mesh_.cornerUvs.empty()) noteCount(mesh_, cornersWithout_, "corners have no UV; they get (0, 0).");
  noteCount(mesh_, linesAndPoints_, "primitives of points or lines are left out.");
  noteCount(mesh_, fallbacks_, "meshes that only stand for strands are left out.");
  noteCount(mesh_, skinned_, "skinned meshes are taken in their bind pose.");
  noteCount(mesh_, morphed_, "primitives are taken without their morph targets.");
  noteCount(mesh_, looseIndices_, "primitives have indices that make no whole triangle; those are left out.");
  noteCount(mesh_, flatIndices_, "triangles that name a vertex twice are left out.");
  return std::move(mesh_);
}

}  // namespace

Result<PolygonMesh> readGltfMesh(Bytes bytes, const std::filesystem::path& path) {
  MemoryBudget budget(bytes.size());
  COIF_ASSIGN(const GltfDocument document, openGltf(bytes, path, budget));
  return GltfMeshReader(document, budget).read();
}

}  // namespace coif::io
