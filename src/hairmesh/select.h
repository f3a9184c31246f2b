// What every operation asks of its arguments.
#pragma once

#include <span>
#include <vector>

#include "coif/hairmesh/hair_mesh.h"
#include "coif/hairmesh/operations.h"
#include "hairmesh/builder.h"

namespace coif::hairmesh {

/// Bundle indices, in the order given. Errors: empty, repeating, unknown.
Result<std::vector<std::uint32_t>> selectBundles(const HairMesh& mesh, std::span<const BundleId> ids);
/// The bundles of faces that must be tips.
Result<std::vector<BundleId>> selectTips(const HairMesh& mesh, std::span<const FaceRef> faces);
/// Index of the bundle of a face that must exist.
Result<std::uint32_t> selectFace(const HairMesh& mesh, FaceRef face);
/// The same for an edge.
Result<std::uint32_t> selectEdge(const HairMesh& mesh, EdgeRef edge);

Error refuse(std::string why, std::string place);
std::string placeOf(FaceRef face);
std::string placeOf(EdgeRef edge);

/// Commits and adds the vertices that are new in the mesh.
Result<Created> commitCreated(HairMeshBuilder& builder, HairMesh& mesh, Created created = {});

}  // namespace coif::hairmesh
