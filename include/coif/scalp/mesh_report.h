// What is odd about a mesh: found, counted and named, never repaired.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "coif/scalp/polygon_mesh.h"

namespace coif {

enum class MeshFault {
  NonFinitePosition,   ///< elements: vertices
  BadFace,             ///< faces with a corner out of range or fewer than three corners; left out of all else
  RepeatedCorner,      ///< faces that name a vertex twice
  ZeroAreaFace,        ///< faces with area below 1e-12 of their longest side squared
  UnreferencedVertex,  ///< vertices without a face
  CoincidentVertices,  ///< vertices at exactly the position of a vertex of lower index
  NonManifoldEdge,     ///< edges of three or more faces; elements: vertex pairs, flat
  NonManifoldVertex,   ///< vertices whose faces form more than one fan
  InconsistentWinding,  ///< edges that two faces run the same way; elements: vertex pairs, flat
  InsideOutShell,       ///< closed shells of negative volume; elements: shells
  OpenShell,            ///< shells with a boundary; elements: shells
  SeveralShells,        ///< elements: shells
};
const char* name(MeshFault fault);

struct MeshFinding {
  MeshFault fault{};
  std::size_t count = 0;
  std::vector<std::uint32_t> elements;  ///< count of them, or 2·count for edges; ascending
  std::string text;                     ///< one sentence
};

/// A set of faces connected by shared vertex indices.
struct Shell {
  std::uint32_t faceCount = 0, vertexCount = 0, edgeCount = 0, boundaryLoops = 0;
  bool closed = false;          ///< no boundary edge
  bool manifold = false;        ///< no non-manifold edge or vertex, and consistent winding
  int genus = -1;               ///< −1 where it is not defined (not manifold)
  double area = 0, volume = 0;  ///< volume: signed, of closed shells only
  Box box;
};

struct MeshReport {
  std::vector<Shell> shells;
  std::vector<std::uint32_t> faceShell;  ///< F, kNone for bad faces
  std::vector<MeshFinding> findings;     ///< in the order of MeshFault, only what was found

  const MeshFinding* find(MeshFault fault) const;
  std::string text() const;  ///< a line a shell (the first 16), a line a finding
};

/// Takes any mesh, valid or not; never fails. Cost: O(C log C), one thread.
MeshReport inspect(const PolygonMesh& mesh);

}  // namespace coif
