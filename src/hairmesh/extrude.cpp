// Face extrude and face delete.
#include <algorithm>

#include "coif/hairmesh/operations.h"
#include "coif/scalp/polygon_mesh.h"
#include "hairmesh/select.h"

namespace coif {
namespace {

using namespace hairmesh;

Status checkOptions(const HairMesh& mesh, const ExtrudeOptions& options) {
  if (!std::isfinite(options.distance) || (options.direction && !options.direction->allFinite())) {
    return refuse("the displacement is not finite", "extrude options");
  }
  if (!options.offsets.empty() && options.offsets.size() != mesh.vertices().size()) {
    return refuse("there must be one offset a vertex of the mesh", "extrude options");
  }
  for (std::size_t v = 0; v < options.offsets.size(); ++v) {
    if (!options.offsets[v].allFinite())
      return refuse("the offset is not finite", placeOf(mesh.vertices()[v].id));
  }
  return {};
}

class Extrusion {
 public:
  Extrusion(HairMeshBuilder& builder, const ExtrudeOptions& options) : b_(builder), options_(options) {}

  Result<Created> run(const std::vector<std::uint32_t>& selection) {
    newLayer_.assign(b_.bundles.size(), kNone);
    for (const std::uint32_t j : selection) {
      newLayer_[j] = b_.layers(j);
      auto& rows = b_.bundles[j].vertices;
      rows.resize(rows.size() + b_.bundles[j].corners, kNone);
    }
    Created created;
    for (const std::uint32_t j : selection) {
      splitFromOthers(j);
      created.faces.push_back({b_.bundles[j].id, newLayer_[j]});
    }
    for (const std::uint32_t j : selection) {
      for (std::uint32_t i = 0; i < b_.bundles[j].corners; ++i) {
        if (b_.at(j, newLayer_[j], i) == kNone) COIF_TRY(addFan(b_.topology.side(j, i)));
      }
    }
    return created;
  }

 private:
  /// The new face shares its edges with faces extruded from the same layer only.
  void splitFromOthers(std::uint32_t j) {
    for (std::uint32_t i = 0; i < b_.bundles[j].corners; ++i) {
      const std::uint32_t side = b_.topology.side(j, i), other = b_.topology.opposite(side);
      if (other == kNone || b_.topology.split(side) < newLayer_[j]) continue;
      const std::uint32_t neighbour = b_.topology.bundleOf(other);
      if (b_.layers(neighbour) > newLayer_[j] && newLayer_[neighbour] != newLayer_[j]) {
        b_.topology.setSplit(side, newLayer_[j]);
      }
    }
  }

  /// One new vertex for the corner `start` and those that shared edges of the new faces connect with it.
  Status addFan(std::uint32_t start) {
    const std::uint32_t layer = newLayer_[b_.topology.bundleOf(start)];
    std::vector<std::uint32_t> fan{start};
    for (std::size_t f = 0; f < fan.size(); ++f) {
      const std::uint32_t out = fan[f], in = b_.topology.prev(out);
      if (b_.joined(out, layer)) visit(fan, b_.topology.next(b_.topology.opposite(out)));
      if (b_.joined(in, layer)) visit(fan, b_.topology.opposite(in));
    }
    const std::uint32_t parent = b_.at(start, layer - 1);
    COIF_ASSIGN(const Vec3 offset, offsetOf(fan, parent));
    const std::uint32_t vertex =
        b_.addVertex(b_.vertices[parent].position + offset, parent, layer, b_.vertices[parent].pinned);
    for (const std::uint32_t corner : fan) b_.at(corner, layer) = vertex;
    return {};
  }

  static void visit(std::vector<std::uint32_t>& fan, std::uint32_t corner) {
    if (std::find(fan.begin(), fan.end(), corner) == fan.end()) fan.push_back(corner);
  }

  Result<Vec3> offsetOf(std::vector<std::uint32_t> fan, std::uint32_t parent) {
    if (!options_.offsets.empty()) return options_.offsets[parent];
    if (options_.direction) return *options_.direction;
    if (options_.distance == 0) return Vec3(Vec3::Zero());
    std::sort(fan.begin(), fan.end());  // the sum must not depend on the order of the selection
    Vec3 normal = Vec3::Zero();
    double scale = 0;
    std::vector<Vec3> polygon;
    for (const std::uint32_t corner : fan) {
      const std::uint32_t j = b_.topology.bundleOf(corner);
      polygon.clear();
      for (std::uint32_t i = 0; i < b_.bundles[j].corners; ++i) {
        polygon.push_back(b_.vertices[b_.at(j, newLayer_[j] - 1, i)].position);
      }
      const Vec3 n = newellNormal(polygon);
      normal += n;
      scale += n.norm();
    }
    const HairVertex& base = b_.vertices[parent];
    // Normals that cancel to rounding have no direction: follow the hair so far.
    if (!(normal.norm() > 1e-9 * scale) && base.parent != kNone) {
      normal = base.position - b_.vertices[base.parent].position;
    }
    const double length = normal.norm();
    if (!(length > 0) || !std::isfinite(length)) {
      return makeError(ErrorCode::Degenerate, "the faces at the vertex have no normal to extrude along",
                       placeOf(base.id));
    }
    return Vec3(normal * (options_.distance / length));
  }

  HairMeshBuilder& b_;
  const ExtrudeOptions& options_;
  std::vector<std::uint32_t> newLayer_;
};

}  // namespace

Result<Created> extrudeFaces(HairMesh& mesh, std::span<const BundleId> bundles,
                             const ExtrudeOptions& options) {
  COIF_ASSIGN(const auto selection, selectBundles(mesh, bundles));
  COIF_TRY(checkOptions(mesh, options));
  COIF_ASSIGN(HairMeshBuilder builder, HairMeshBuilder::from(mesh));
  COIF_ASSIGN(Created created, Extrusion(builder, options).run(selection));
  return commitCreated(builder, mesh, std::move(created));
}

Result<Created> extrudeFaces(HairMesh& mesh, std::span<const FaceRef> tips, const ExtrudeOptions& options) {
  COIF_ASSIGN(const auto bundles, selectTips(mesh, tips));
  return extrudeFaces(mesh, bundles, options);
}

Result<Created> deleteFaces(HairMesh& mesh, std::span<const BundleId> bundles) {
  COIF_ASSIGN(const auto selection, selectBundles(mesh, bundles));
  COIF_ASSIGN(HairMeshBuilder builder, HairMeshBuilder::from(mesh));
  std::vector<std::pair<std::uint32_t, std::uint32_t>> touched;  // root vertex, lowest layer that lost a face
  for (const std::uint32_t j : selection) {
    Bundle& bundle = builder.bundles[j];
    const std::uint32_t height = bundle.height();
    for (const std::uint32_t v : mesh.bundles()[j].face(0)) touched.emplace_back(v, height);
    bundle.vertices.resize(std::size_t(height) * bundle.corners);
  }
  std::sort(touched.begin(), touched.end());
  for (std::size_t i = 0; i < touched.size(); ++i) {
    if (i > 0 && touched[i].first == touched[i - 1].first) continue;
    builder.regroup(touched[i].first, touched[i].second, HairMeshBuilder::Welds::Hold);
  }
  return commitCreated(builder, mesh);
}

Result<Created> deleteFaces(HairMesh& mesh, std::span<const FaceRef> tips) {
  COIF_ASSIGN(const auto bundles, selectTips(mesh, tips));
  return deleteFaces(mesh, bundles);
}

}  // namespace coif
