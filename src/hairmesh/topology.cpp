#include "hairmesh/topology.h"

#include <algorithm>
#include <numeric>

#include "hairmesh/root_connectivity.h"

namespace coif::hairmesh {

void SmallSets::reset(std::size_t n) {
  up_.resize(n);
  std::iota(up_.begin(), up_.end(), 0u);
}

std::uint32_t SmallSets::find(std::uint32_t x) {
  while (up_[x] != x) x = up_[x] = up_[up_[x]];
  return x;
}

void SmallSets::unite(std::uint32_t a, std::uint32_t b) {
  a = find(a), b = find(b);
  if (a != b) up_[std::max(a, b)] = std::min(a, b);
}

Result<Topology> Topology::build(std::size_t vertexCount, std::span<const Bundle> bundles,
                                 std::span<const EdgeSplit> splits) {
  Topology t;
  std::vector<std::uint32_t> corners;
  t.offsets_.reserve(bundles.size() + 1);
  t.offsets_.push_back(0);
  for (std::uint32_t j = 0; j < bundles.size(); ++j) {
    const auto face = bundles[j].face(0);
    corners.insert(corners.end(), face.begin(), face.end());
    t.bundle_.insert(t.bundle_.end(), face.size(), j);
    t.offsets_.push_back(std::uint32_t(corners.size()));
  }
  // OpenMesh sees the root vertices only.
  std::vector<std::uint32_t> compact(vertexCount, kNone);
  for (const std::uint32_t v : corners) compact[v] = 0;
  std::uint32_t used = 0;
  for (std::uint32_t& index : compact) {
    if (index == 0) index = used++;
  }
  for (std::uint32_t& v : corners) v = compact[v];
  COIF_ASSIGN(t.opposite_, oppositeSides(used, t.offsets_, corners));
  COIF_TRY(t.renumber(vertexCount, bundles, splits));
  return t;
}

Status Topology::renumber(std::size_t vertexCount, std::span<const Bundle> bundles,
                          std::span<const EdgeSplit> splits) {
  const auto rootVertex = [&](std::uint32_t c) { return bundles[bundle_[c]].vertices[cornerOf(c)]; };
  aroundOffsets_.assign(vertexCount + 1, 0);
  for (std::uint32_t c = 0; c < sideCount(); ++c) ++aroundOffsets_[rootVertex(c) + 1];
  std::partial_sum(aroundOffsets_.begin(), aroundOffsets_.end(), aroundOffsets_.begin());
  around_.resize(sideCount());
  slot_.resize(sideCount());
  std::vector<std::uint32_t> filled(vertexCount, 0);
  for (std::uint32_t c = 0; c < sideCount(); ++c) {
    const std::uint32_t v = rootVertex(c);
    slot_[c] = filled[v]++;
    around_[aroundOffsets_[v] + slot_[c]] = c;
  }
  split_.assign(sideCount(), kNone);
  for (const EdgeSplit& split : splits) {
    const std::uint32_t side =
        split.a < vertexCount && split.b < vertexCount ? findEdge(bundles, split.a, split.b) : kNone;
    if (side == kNone || opposite_[side] == kNone) {
      return makeError(ErrorCode::Degenerate, "a split names no root edge that two bundles share",
                       "vertices " + std::to_string(split.a) + " and " + std::to_string(split.b));
    }
    setSplit(side, split.layer);
  }
  return {};
}

std::uint32_t Topology::findEdge(std::span<const Bundle> bundles, std::uint32_t a, std::uint32_t b) const {
  const auto rootVertex = [&](std::uint32_t side) { return bundles[bundle_[side]].vertices[cornerOf(side)]; };
  for (const std::uint32_t c : around(a)) {
    if (rootVertex(next(c)) == b) return c;
    if (rootVertex(prev(c)) == b) return prev(c);
  }
  return kNone;
}

void fanLabels(const Topology& topology, std::span<const Bundle> bundles, std::uint32_t rootVertex,
               std::uint32_t layer, std::vector<std::uint32_t>& labels) {
  const auto corners = topology.around(rootVertex);
  labels.resize(corners.size());
  for (std::uint32_t i = 0; i < corners.size(); ++i) {
    labels[i] = layer < layerCountOf(bundles[topology.bundleOf(corners[i])]) ? i : kNone;
  }
  // Fans are short paths or cycles: lower labels along joined edges until nothing changes.
  for (bool changed = true; changed;) {
    changed = false;
    for (std::uint32_t i = 0; i < corners.size(); ++i) {
      if (labels[i] == kNone || !topology.joined(bundles, corners[i], layer)) continue;
      const std::uint32_t at = topology.slot(topology.next(topology.opposite(corners[i])));
      if (labels[i] == labels[at]) continue;
      labels[i] = labels[at] = std::min(labels[i], labels[at]);
      changed = true;
    }
  }
}

}  // namespace coif::hairmesh
