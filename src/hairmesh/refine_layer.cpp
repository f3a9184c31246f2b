#include "hairmesh/refine_layer.h"

#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>

#include <memory>

namespace coif::hairmesh {
namespace {

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

struct Point {
  Vec3 value = Vec3::Zero();
  void Clear(void* = nullptr) { value.setZero(); }
  void AddWithWeight(const Point& other, double weight) { value += weight * other.value; }
};

std::unique_ptr<Far::TopologyRefiner> makeRefiner(const LayerMesh& mesh, SubdivisionScheme scheme) {
  std::vector<int> creaseVertices;
  for (const auto& [a, b] : mesh.creases) creaseVertices.insert(creaseVertices.end(), {a, b});
  const std::vector<float> creaseWeights(mesh.creases.size(), Sdc::Crease::SHARPNESS_INFINITE);
  const std::vector<float> cornerWeights(mesh.fixed.size(), Sdc::Crease::SHARPNESS_INFINITE);
  Far::TopologyDescriptor descriptor;
  descriptor.numVertices = int(mesh.positions.size());
  descriptor.numFaces = int(mesh.faceSizes.size());
  descriptor.numVertsPerFace = mesh.faceSizes.data();
  descriptor.vertIndicesPerFace = mesh.corners.data();
  descriptor.numCreases = int(mesh.creases.size());
  descriptor.creaseVertexIndexPairs = creaseVertices.data();
  descriptor.creaseWeights = creaseWeights.data();
  descriptor.numCorners = int(mesh.fixed.size());
  descriptor.cornerVertexIndices = mesh.fixed.data();
  descriptor.cornerWeights = cornerWeights.data();
  // A corner of the outline (a vertex of one face) stays, so refining one quad leaves its outline where it
  // was.
  Sdc::Options options;
  options.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
  using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
  const Sdc::SchemeType type = scheme == SubdivisionScheme::Loop ? Sdc::SCHEME_LOOP : Sdc::SCHEME_CATMARK;
  return std::unique_ptr<Far::TopologyRefiner>(Factory::Create(descriptor, Factory::Options(type, options)));
}

}  // namespace

Result<RefinedLayer> refineLayer(const LayerMesh& mesh, SubdivisionScheme scheme) {
  RefinedLayer result;
  if (mesh.faceSizes.empty()) return result;
  const auto refiner = makeRefiner(mesh, scheme);
  if (!refiner) return makeError(ErrorCode::Degenerate, "OpenSubdiv cannot refine this layer");
  refiner->RefineUniform(Far::TopologyRefiner::UniformOptions(1));
  std::vector<Point> coarse(mesh.positions.size()), fine(std::size_t(refiner->GetLevel(1).GetNumVertices()));
  for (std::size_t v = 0; v < coarse.size(); ++v) coarse[v].value = mesh.positions[v];
  Far::PrimvarRefinerReal<double>(*refiner).Interpolate(1, coarse, fine);

  const Far::TopologyLevel& base = refiner->GetLevel(0);
  for (int v = 0; v < base.GetNumVertices(); ++v) {
    result.vertices.push_back(fine[std::size_t(base.GetVertexChildVertex(v))].value);
  }
  for (int f = 0; f < base.GetNumFaces(); ++f) {
    const Far::ConstIndexArray edges = base.GetFaceEdges(f);
    for (int i = 0; i < edges.size(); ++i) {
      result.sides.push_back(fine[std::size_t(base.GetEdgeChildVertex(edges[i]))].value);
    }
    if (scheme == SubdivisionScheme::CatmullClark) {
      result.faces.push_back(fine[std::size_t(base.GetFaceChildVertex(f))].value);
    }
  }
  return result;
}

}  // namespace coif::hairmesh
