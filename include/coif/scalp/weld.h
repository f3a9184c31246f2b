// Joining vertices that lie on each other, on request: real heads come split along their UV seams.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "coif/base/result.h"
#include "coif/scalp/polygon_mesh.h"

namespace coif {

struct WeldOptions {
  double tolerance = 0;  ///< mesh units, >= 0; 0 joins exactly equal positions only
};

struct WeldReport {
  std::size_t mergedVertices = 0;             ///< vertices that went into another
  std::vector<std::uint32_t> vertexMap;       ///< old vertex → new vertex
  std::vector<std::uint32_t> faceMap;         ///< new face → old face
  std::vector<std::uint32_t> droppedFaces;    ///< old faces left with fewer than three different corners
  std::vector<std::uint32_t> shortenedFaces;  ///< old faces that lost corners and stayed
  std::vector<std::uint32_t> pinchedFaces;    ///< old faces that now name a vertex twice, kept as they are
  std::size_t nonManifoldEdgesBefore = 0, nonManifoldEdgesAfter = 0;
  double greatestMove = 0;  ///< mesh units, at most the tolerance
  std::string text() const;
};

struct Welded {
  PolygonMesh mesh;
  WeldReport report;
};

/// Every vertex joins the vertex of lowest index within the tolerance, and takes its position; so no vertex
/// moves by more than the tolerance, chains of near vertices do not collapse, and a second weld changes
/// nothing at tolerance 0. Corners keep their UVs. Faces, groups, names, units and vertices without a face
/// survive. Errors: those of validate(); InvalidArgument for a tolerance that is negative or not finite.
/// Cost: O((V + C) log(V + C)), one thread.
Result<Welded> weld(const PolygonMesh& mesh, const WeldOptions& options = {});

}  // namespace coif
