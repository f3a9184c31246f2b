#include "hairmesh/root_connectivity.h"

#include <OpenMesh/Core/Mesh/PolyConnectivity.hh>

#include "coif/base/vec.h"

namespace coif::hairmesh {
namespace {

using Connectivity = OpenMesh::PolyConnectivity;
using OpenMesh::SmartHalfedgeHandle;
using OpenMesh::SmartVertexHandle;

Error edgeFault(std::size_t face) {
  return makeError(
      ErrorCode::Degenerate,
      "the root layer has an edge of three or more faces, or of two faces that run along it the same way",
      "face " + std::to_string(face));
}

/// What OpenMesh's add_face would refuse, asked first because it prints to the standard error when it does.
Status canAdd(const Connectivity& mesh, std::span<const SmartVertexHandle> face, std::size_t f) {
  for (std::size_t i = 0; i < face.size(); ++i) {
    if (!mesh.is_boundary(face[i])) {
      return makeError(ErrorCode::Degenerate,
                       "the root layer has a vertex whose faces form more than one fan",
                       "face " + std::to_string(f));
    }
    const auto halfedge = mesh.find_halfedge(face[i], face[(i + 1) % face.size()]);
    if (halfedge.is_valid() && !mesh.is_boundary(halfedge)) return edgeFault(f);
  }
  return {};
}

}  // namespace

Result<std::vector<std::uint32_t>> oppositeSides(std::uint32_t vertexCount,
                                                 std::span<const std::uint32_t> offsets,
                                                 std::span<const std::uint32_t> corners) {
  const std::size_t faces = offsets.size() - 1;
  Connectivity mesh;
  mesh.reserve(vertexCount, corners.size(), faces);
  for (std::uint32_t v = 0; v < vertexCount; ++v) mesh.new_vertex();
  std::vector<SmartVertexHandle> face;
  for (std::size_t f = 0; f < faces; ++f) {
    face.clear();
    for (std::uint32_t c = offsets[f]; c < offsets[f + 1]; ++c) {
      face.push_back(OpenMesh::make_smart(OpenMesh::VertexHandle(int(corners[c])), mesh));
    }
    COIF_TRY(canAdd(mesh, face, f));
    if (!mesh.add_face(face).is_valid()) return edgeFault(f);
  }
  for (std::uint32_t v = 0; v < vertexCount; ++v) {
    if (!mesh.is_manifold(OpenMesh::VertexHandle(int(v)))) {
      return makeError(ErrorCode::Degenerate,
                       "the root layer has a vertex whose faces form more than one fan",
                       "root vertex " + std::to_string(v));
    }
  }
  std::vector<std::uint32_t> sideOf(mesh.n_halfedges(), kNone), result(corners.size(), kNone);
  for (std::size_t f = 0; f < faces; ++f) {
    auto halfedge = mesh.halfedge_handle(OpenMesh::FaceHandle(int(f)));
    while (std::uint32_t(mesh.from_vertex_handle(halfedge).idx()) != corners[offsets[f]]) {
      halfedge = mesh.next_halfedge_handle(halfedge);
    }
    for (std::uint32_t c = offsets[f]; c < offsets[f + 1];
         ++c, halfedge = mesh.next_halfedge_handle(halfedge)) {
      sideOf[std::size_t(halfedge.idx())] = c;
    }
  }
  for (std::size_t h = 0; h < sideOf.size(); ++h) {
    if (sideOf[h] != kNone) result[sideOf[h]] = sideOf[h ^ 1];  // OpenMesh pairs halfedges 2e and 2e + 1
  }
  return result;
}

}  // namespace coif::hairmesh
