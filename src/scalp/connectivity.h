// Edges, components and coincident vertices of polygon soup; nothing here assumes a manifold.
#pragma once

#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "coif/scalp/polygon_mesh.h"

namespace coif {

/// Union-find; the representative is the least member, so results do not depend on the order of unions.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::uint32_t find(std::uint32_t x) {
    while (parent_[x] != x) x = parent_[x] = parent_[parent_[x]];
    return x;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a), b = find(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

/// One side of a face: corner `corner` (of PolygonMesh::corners) to the next corner of the same face.
struct EdgeUse {
  std::uint32_t a = 0, b = 0;  ///< vertices, a < b
  std::uint32_t face = 0, corner = 0, nextCorner = 0;
  bool forward = true;  ///< runs a → b
};

/// E edges with their uses, ordered by (a, b, corner). Sides that join a vertex to itself are left out.
struct EdgeTable {
  std::vector<EdgeUse> uses;
  std::vector<std::uint32_t> offsets{0};  ///< E + 1
  std::size_t size() const { return offsets.size() - 1; }
  std::span<const EdgeUse> edge(std::size_t e) const {
    return std::span(uses).subspan(offsets[e], offsets[e + 1] - offsets[e]);
  }
};

/// Offsets must be sound; corners are taken as `corners[c]` (pass mesh.corners, or welded names of them).
EdgeTable buildEdges(std::span<const std::uint32_t> faceOffsets, std::span<const std::uint32_t> corners);

/// Component of every corner among the corners of its vertex: two corners are in one fan when their faces
/// share an edge at the vertex. A vertex with more than one fan is a bow-tie.
DisjointSets cornerFans(const EdgeTable& edges, std::size_t cornerCount);

/// For every vertex the lowest vertex within `tolerance` that stands for it (itself included); 0: equal
/// positions. No vertex is farther than `tolerance` from its representative. Positions that are not finite
/// stand alone.
std::vector<std::uint32_t> coincidentRepresentatives(std::span<const Vec3> positions, double tolerance);

/// Shell (connected by shared vertices) of every face, numbered 0, 1, … by first face.
std::vector<std::uint32_t> faceShells(std::span<const std::uint32_t> faceOffsets,
                                      std::span<const std::uint32_t> corners, std::size_t vertexCount);

}  // namespace coif
