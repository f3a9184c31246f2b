#include "hairmesh/select.h"

#include <algorithm>

namespace coif::hairmesh {

Error refuse(std::string why, std::string place) {
  return makeError(ErrorCode::InvalidArgument, std::move(why), std::move(place));
}

std::string placeOf(FaceRef face) {
  return "bundle " + std::to_string(std::uint32_t(face.bundle)) + ", layer " + std::to_string(face.layer);
}

std::string placeOf(EdgeRef edge) {
  return placeOf(FaceRef{edge.bundle, edge.layer}) + ", side " + std::to_string(edge.side);
}

Result<std::vector<std::uint32_t>> selectBundles(const HairMesh& mesh, std::span<const BundleId> ids) {
  if (ids.empty()) return refuse("no bundle is selected", "selection");
  std::vector<std::uint32_t> result;
  std::vector<std::uint8_t> taken(mesh.bundles().size(), 0);
  for (const BundleId id : ids) {
    const std::uint32_t j = mesh.indexOf(id);
    if (j == kNone) return makeError(ErrorCode::NotFound, "the mesh has no such bundle", placeOf(id));
    if (taken[j]++) return refuse("the bundle is selected twice", placeOf(id));
    result.push_back(j);
  }
  return result;
}

Result<std::uint32_t> selectFace(const HairMesh& mesh, FaceRef face) {
  const std::uint32_t j = mesh.indexOf(face.bundle);
  if (j == kNone) return makeError(ErrorCode::NotFound, "the mesh has no such bundle", placeOf(face.bundle));
  if (face.layer > mesh.bundles()[j].height()) {
    return makeError(ErrorCode::NotFound, "the bundle ends below this layer", placeOf(face));
  }
  return j;
}

Result<std::uint32_t> selectEdge(const HairMesh& mesh, EdgeRef edge) {
  COIF_ASSIGN(const std::uint32_t j, selectFace(mesh, {edge.bundle, edge.layer}));
  if (edge.side >= mesh.bundles()[j].corners) {
    return makeError(ErrorCode::NotFound, "the face has no such side", placeOf(edge));
  }
  return j;
}

Result<std::vector<BundleId>> selectTips(const HairMesh& mesh, std::span<const FaceRef> faces) {
  std::vector<BundleId> ids;
  for (const FaceRef& face : faces) {
    COIF_ASSIGN(const std::uint32_t j, selectFace(mesh, face));
    if (face.layer != mesh.bundles()[j].height())
      return refuse("the face is not its bundle's tip", placeOf(face));
    ids.push_back(face.bundle);
  }
  return ids;
}

Result<Created> commitCreated(HairMeshBuilder& builder, HairMesh& mesh, Created created) {
  const VertexId firstNew{mesh.nextVertexId()};
  COIF_TRY(builder.commit(mesh));
  const auto vertices = mesh.vertices();
  auto fresh = std::lower_bound(vertices.begin(), vertices.end(), firstNew,
                                [](const HairVertex& v, VertexId id) { return v.id < id; });
  for (; fresh != vertices.end(); ++fresh) created.vertices.push_back(fresh->id);
  return created;
}

}  // namespace coif::hairmesh
