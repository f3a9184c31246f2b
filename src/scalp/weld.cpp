#include "coif/scalp/weld.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "connectivity.h"

namespace coif {
namespace {

std::size_t nonManifoldEdges(const PolygonMesh& mesh) {
  const EdgeTable edges = buildEdges(mesh.faceOffsets, mesh.corners);
  std::size_t count = 0;
  for (std::size_t e = 0; e < edges.size(); ++e) count += edges.edge(e).size() > 2;
  return count;
}

void keepRepresentatives(const PolygonMesh& in, double tolerance, Welded& out) {
  WeldReport& report = out.report;
  const auto lowest = coincidentRepresentatives(in.positions, tolerance);
  report.vertexMap.resize(in.vertexCount());
  for (std::uint32_t v = 0; v < in.vertexCount(); ++v) {
    if (lowest[v] == v) {
      report.vertexMap[v] = std::uint32_t(out.mesh.positions.size());
      out.mesh.positions.push_back(in.positions[v]);
    } else {
      report.vertexMap[v] = report.vertexMap[lowest[v]];
      report.greatestMove = std::max(report.greatestMove, (in.positions[v] - in.positions[lowest[v]]).norm());
      ++report.mergedVertices;
    }
  }
}

void rebuildFaces(const PolygonMesh& in, Welded& out) {
  WeldReport& report = out.report;
  for (std::uint32_t f = 0; f < in.faceCount(); ++f) {
    std::vector<std::uint32_t> kept;  // corner numbers of `in`
    for (std::uint32_t c = in.faceOffsets[f]; c < in.faceOffsets[f + 1]; ++c)
      if (kept.empty() || report.vertexMap[in.corners[kept.back()]] != report.vertexMap[in.corners[c]])
        kept.push_back(c);
    while (kept.size() > 1 &&
           report.vertexMap[in.corners[kept.back()]] == report.vertexMap[in.corners[kept[0]]])
      kept.pop_back();
    std::vector<std::uint32_t> vertices;
    for (std::uint32_t c : kept) vertices.push_back(report.vertexMap[in.corners[c]]);
    std::vector<std::uint32_t> different = vertices;
    std::sort(different.begin(), different.end());
    different.erase(std::unique(different.begin(), different.end()), different.end());
    if (different.size() < 3) {
      report.droppedFaces.push_back(f);
      continue;
    }
    if (vertices.size() < in.face(f).size()) report.shortenedFaces.push_back(f);
    if (different.size() < vertices.size()) report.pinchedFaces.push_back(f);
    out.mesh.addFace(vertices);
    report.faceMap.push_back(f);
    if (!in.cornerUvs.empty())
      for (std::uint32_t c : kept) out.mesh.cornerUvs.push_back(in.cornerUvs[c]);
    if (!in.faceGroups.empty()) out.mesh.faceGroups.push_back(in.faceGroups[f]);
  }
}

}  // namespace

Result<Welded> weld(const PolygonMesh& mesh, const WeldOptions& options) {
  COIF_TRY(validate(mesh));
  if (!(options.tolerance >= 0) || !std::isfinite(options.tolerance))
    return makeError(ErrorCode::InvalidArgument, "The weld tolerance must be a number of 0 or more.");
  Welded out;
  out.mesh.groupNames = mesh.groupNames;
  out.mesh.metersPerUnit = mesh.metersPerUnit;
  out.mesh.upAxis = mesh.upAxis;
  out.mesh.notes = mesh.notes;
  keepRepresentatives(mesh, options.tolerance, out);
  rebuildFaces(mesh, out);
  out.report.nonManifoldEdgesBefore = nonManifoldEdges(mesh);
  out.report.nonManifoldEdgesAfter = nonManifoldEdges(out.mesh);
  return out;
}

std::string WeldReport::text() const {
  std::ostringstream out;
  out << mergedVertices << " vertices joined others, " << droppedFaces.size()
      << " faces collapsed and were dropped, " << shortenedFaces.size() << " lost corners, "
      << pinchedFaces.size() << " name a vertex twice; edges of three "
      << "faces or more: " << nonManifoldEdgesBefore << " before, " << nonManifoldEdgesAfter << " after.";
  return out.str();
}

}  // namespace coif
