// UsdSkel's binding primvars out of a USD layer, vertex by vertex of the mesh that is read from it.
#include <Eigen/LU>
#include <cmath>
#include <unordered_map>

#include "formats.h"
#include "usd_skin.h"
#include "usd_walk.h"

namespace coif::io {
namespace {

using namespace usd;

/// What a prim says of its skeleton or takes from the prims above.
struct Rig {
  std::string skeleton;
  std::vector<std::string> joints;
};

Rig rigAt(const Prim& prim, Rig rig) {
  for (const Relationship& relationship : prim.relationships) {
    if (relationship.name == "skel:skeleton" && relationship.targets.size() == 1)
      rig.skeleton = relationship.targets[0];
  }
  if (const Value* joints = prim.value("skel:joints")) rig.joints = joints->strings;
  return rig;
}

using Rigs = std::unordered_map<const Prim*, Rig>;  // of meshes; looked up, never walked

void collectRigs(const Prim& prim, const Rig& above, Rigs& rigs) {
  const Rig here = rigAt(prim, above);
  if (prim.typeName == "Mesh") rigs[&prim] = here;
  for (const Prim& child : prim.children) collectRigs(child, here, rigs);
}

/// The prim at a path such as /Rig/Skeleton; null when the layer has none.
const Prim* primAt(const std::vector<Prim>& prims, std::string_view path) {
  if (!path.starts_with('/')) return nullptr;
  path.remove_prefix(1);
  const std::string_view name = path.substr(0, path.find('/'));
  for (const Prim& prim : prims) {
    if (prim.name != name) continue;
    return name.size() == path.size() ? &prim : primAt(prim.children, path.substr(name.size()));
  }
  return nullptr;
}

struct Influences {
  std::size_t count = 0;  ///< an element
  bool rigid = false;
  std::vector<std::int64_t> joints;
  std::vector<float> weights;
};

constexpr const char* kJoints = "primvars:skel:jointIndices";
constexpr const char* kWeights = "primvars:skel:jointWeights";

Result<Influences> influencesOf(const Prim& prim, std::size_t vertices, std::size_t jointCount,
                                MemoryBudget& budget) {
  const Value &joints = *prim.value(kJoints), &weights = *prim.value(kWeights);
  if (prim.value(std::string(kJoints) + ":indices") != nullptr ||
      prim.value(std::string(kWeights) + ":indices") != nullptr) {
    return makeError(ErrorCode::Unsupported, "joint influences are indexed");
  }
  COIF_TRY(budget.take(joints.array.count + weights.array.count, 2 * sizeof(std::int64_t)));
  Influences out;
  out.joints = numbers<std::int64_t>(joints);
  out.weights = numbers<float>(weights);
  out.rigid = interpolationOf(prim, kJoints) == "constant";
  const double size = firstNumber(find(prim.attribute(kJoints)->metadata, "elementSize"), 1);
  const std::size_t elements = out.rigid ? 1 : vertices;
  if (!(size >= 1 && size <= 65536) || out.joints.size() != std::size_t(size) * elements ||
      out.weights.size() != out.joints.size()) {
    return makeError(ErrorCode::Malformed, "joint indices and weights do not fit the points");
  }
  out.count = std::size_t(size);
  for (std::size_t i = 0; i < out.joints.size(); ++i) {
    if (out.joints[i] < 0 || std::uint64_t(out.joints[i]) >= jointCount)
      return makeError(ErrorCode::Malformed, "a joint index is out of range");
    if (!std::isfinite(out.weights[i]) || out.weights[i] < 0)
      return makeError(ErrorCode::Malformed, "a joint weight is negative or not finite");
  }
  return out;
}

/// Copies rows of one mesh, widened to the binding's influences and scaled to add up to 1.
void appendRows(const Influences& in, std::size_t vertices, SkinBinding& out) {
  for (std::size_t v = 0; v < vertices; ++v) {
    const std::size_t first = in.rigid ? 0 : v * in.count;
    double total = 0;
    for (std::size_t i = 0; i < in.count; ++i) total += double(in.weights[first + i]);
    for (std::size_t i = 0; i < out.influences; ++i) {
      const bool there = i < in.count && total > 0;
      out.joints.push_back(there ? std::uint32_t(in.joints[first + i]) : 0);
      out.weights.push_back(there ? float(double(in.weights[first + i]) / total) : 0);
    }
  }
}

Eigen::Matrix4d bindFromScene(const Placed& placed) {
  Eigen::Matrix4d bind = Eigen::Matrix4d::Identity();
  const Value* stated = placed.prim->value("primvars:skel:geomBindTransform");
  if (stated != nullptr && stated->type.components == 16) {
    const std::vector<double> m = numbers<double>(*stated);
    for (std::size_t i = 0; i < 16 && m.size() == 16; ++i) bind(int(i % 4), int(i / 4)) = m[i];
  }
  return bind * placed.worldFromPrim.inverse();
}

class SkinImport {
 public:
  SkinImport(const Layer& layer, MemoryBudget& budget) : layer_(layer), budget_(budget) {
    for (const Prim& prim : layer.prims) collectRigs(prim, {}, rigs_);
  }

  Status add(const Placed& placed) {
    const std::size_t vertices = vertexCountOf(*placed.prim);
    Part part{vertices, {}};
    if (placed.prim->value(kJoints) != nullptr && placed.prim->value(kWeights) != nullptr && vertices > 0) {
      auto status = bind(placed, part);
      if (!status.ok()) {
        Error error = status.error();
        error.place = placed.path;
        return error;
      }
    }
    parts_.push_back(std::move(part));
    return {};
  }

  Result<std::optional<SkinBinding>> finish() {
    if (!bound_) return std::optional<SkinBinding>();
    for (const Part& part : parts_)
      COIF_TRY(budget_.take(part.vertices * binding_.influences, 2 * sizeof(float)));
    for (const Part& part : parts_) appendRows(part.influences, part.vertices, binding_);
    makeRigidIfUniform(binding_);
    return std::optional(std::move(binding_));
  }

 private:
  struct Part {
    std::size_t vertices = 0;
    Influences influences;
  };

  Status bind(const Placed& placed, Part& part) {
    const Rig& rig = rigs_.at(placed.prim);
    if (rig.skeleton.empty()) return makeError(ErrorCode::Malformed, "the mesh names no skeleton");
    if (!isPrimPath(rig.skeleton))
      return makeError(ErrorCode::Unsupported, "the skeleton is not named by an absolute path of prims");
    const Prim* skeleton = primAt(layer_.prims, rig.skeleton);
    const Value* order = skeleton == nullptr ? nullptr : skeleton->value("joints");
    const std::size_t joints = !rig.joints.empty() ? rig.joints.size()
                               : order != nullptr  ? order->strings.size()
                                                   : kNone;  // the skeleton lies in another file
    COIF_ASSIGN(part.influences, influencesOf(*placed.prim, part.vertices, joints, budget_));
    const Eigen::Matrix4d from = bindFromScene(placed);
    if (!from.allFinite()) return makeError(ErrorCode::Degenerate, "the bind transform is not finite");
    if (!bound_) {
      binding_.skeleton = rig.skeleton;
      binding_.jointNames = rig.joints;
      binding_.bindFromScene = from;
    } else if (binding_.skeleton != rig.skeleton || binding_.jointNames != rig.joints) {
      return makeError(ErrorCode::Unsupported, "meshes are bound to different skeletons or joints");
    } else if (!binding_.bindFromScene.isApprox(from, 1e-6)) {  // products of single-precision matrices
      return makeError(ErrorCode::Unsupported, "meshes are bound at different places");
    }
    bound_ = true;
    binding_.influences = std::max(binding_.influences, std::uint32_t(part.influences.count));
    return {};
  }

  const Layer& layer_;
  MemoryBudget& budget_;
  Rigs rigs_;
  bool bound_ = false;
  SkinBinding binding_;
  std::vector<Part> parts_;
};

}  // namespace

Result<std::optional<SkinBinding>> readUsdSkin(Bytes bytes, const std::filesystem::path& path) {
  MemoryBudget budget(bytes.size());
  const auto read = [&]() -> Result<std::optional<SkinBinding>> {
    COIF_ASSIGN(const Layer layer, readLayer(bytes, budget));
    std::vector<std::string> notes;
    COIF_ASSIGN(const std::vector<Placed> meshes, meshesOf(layer, budget, notes));
    SkinImport import(layer, budget);
    for (const Placed& placed : meshes) COIF_TRY(import.add(placed));
    return import.finish();
  };
  auto skin = read();
  if (!skin.ok()) return inFile(skin.error(), path.string());
  return skin;
}

}  // namespace coif::io
