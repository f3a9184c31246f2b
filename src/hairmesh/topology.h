// Adjacency of every layer: the root layer's, filtered by heights and splits.
//
// A *side* is named by a number: offset(bundle) + i for the side from corner i to corner i + 1. The same
// number names corner i. Sides on one root edge are opposite on every layer where the edge is joined.
#pragma once

#include <span>
#include <vector>

#include "coif/hairmesh/hair_mesh.h"

namespace coif::hairmesh {

/// Number of layers of a bundle: height + 1, or 0 for one whose faces are all deleted.
inline std::uint32_t layerCountOf(const Bundle& bundle) {
  return std::uint32_t(bundle.vertices.size()) / bundle.corners;
}

class Topology {
 public:
  /// Precondition: bundles have at least one layer each, indices in range, corners of a face distinct.
  /// Errors: those of oppositeSides, and a split that names no shared root edge.
  static Result<Topology> build(std::size_t vertexCount, std::span<const Bundle> bundles,
                                std::span<const EdgeSplit> splits);

  /// The same root faces with other vertex indices and splits: keeps the adjacency.
  Status renumber(std::size_t vertexCount, std::span<const Bundle> bundles,
                  std::span<const EdgeSplit> splits);

  std::uint32_t sideCount() const { return std::uint32_t(bundle_.size()); }
  std::uint32_t side(std::uint32_t bundle, std::uint32_t corner) const { return offsets_[bundle] + corner; }
  std::uint32_t bundleOf(std::uint32_t side) const { return bundle_[side]; }
  std::uint32_t cornerOf(std::uint32_t side) const { return side - offsets_[bundle_[side]]; }
  std::uint32_t next(std::uint32_t side) const {
    return side + 1 == offsets_[bundle_[side] + 1] ? offsets_[bundle_[side]] : side + 1;
  }
  std::uint32_t prev(std::uint32_t side) const {
    return side == offsets_[bundle_[side]] ? offsets_[bundle_[side] + 1] - 1 : side - 1;
  }
  std::uint32_t opposite(std::uint32_t side) const { return opposite_[side]; }

  /// First layer on which the two bundles no longer share the edge; kNone when they do up to the lower tip.
  std::uint32_t split(std::uint32_t side) const { return split_[side]; }
  void setSplit(std::uint32_t side, std::uint32_t layer) {
    split_[side] = layer;
    if (opposite_[side] != kNone) split_[opposite_[side]] = layer;
  }

  /// Do two bundles share this side's edge on `layer`?
  bool joined(std::span<const Bundle> bundles, std::uint32_t side, std::uint32_t layer) const {
    const std::uint32_t other = opposite_[side];
    return other != kNone && layer < split_[side] && layer < layerCountOf(bundles[bundle_[side]]) &&
           layer < layerCountOf(bundles[bundle_[other]]);
  }

  /// Corners at a root vertex (by the index that build() saw), ascending.
  std::span<const std::uint32_t> around(std::uint32_t rootVertex) const {
    return std::span(around_).subspan(aroundOffsets_[rootVertex],
                                      aroundOffsets_[rootVertex + 1] - aroundOffsets_[rootVertex]);
  }
  /// Position of a corner in around() of its root vertex.
  std::uint32_t slot(std::uint32_t corner) const { return slot_[corner]; }
  std::uint32_t vertexCount() const { return std::uint32_t(aroundOffsets_.size()) - 1; }

  /// The side from root vertex a to b or from b to a; kNone when there is none.
  std::uint32_t findEdge(std::span<const Bundle> bundles, std::uint32_t a, std::uint32_t b) const;

 private:
  std::vector<std::uint32_t> offsets_, bundle_, opposite_, split_, aroundOffsets_, around_, slot_;
};

/// Labels of the fans at a root vertex on one layer: corners that joined edges connect have the same label,
/// the least position among them in around(rootVertex); kNone for bundles that do not reach the layer.
void fanLabels(const Topology& topology, std::span<const Bundle> bundles, std::uint32_t rootVertex,
               std::uint32_t layer, std::vector<std::uint32_t>& labels);

/// Union–find over a handful of elements; roots are the least members.
class SmallSets {
 public:
  void reset(std::size_t n);
  std::uint32_t find(std::uint32_t x);
  void unite(std::uint32_t a, std::uint32_t b);

 private:
  std::vector<std::uint32_t> up_;
};

}  // namespace coif::hairmesh
