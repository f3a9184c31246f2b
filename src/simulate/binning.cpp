#include "simulate/binning.h"

#include <algorithm>
#include <map>
#include <tuple>

namespace coif {

namespace {

using Key = std::tuple<std::uint32_t, std::vector<std::int32_t>, bool, bool, bool>;

std::vector<std::int32_t> shapeOf(const ChainSet& c, std::size_t tree) {
  const std::uint32_t begin = c.treeOffsets[tree];
  std::vector<std::int32_t> shape{-1};
  for (std::uint32_t i = begin + 1; i < c.treeOffsets[tree + 1]; ++i)
    shape.push_back(std::int32_t(c.parents[i] - begin));
  return shape;
}

// Greedy, in order of the trees.
std::vector<std::uint32_t> colours(const ChainSet& c) {
  const std::vector<std::uint32_t> treeOf = treeOfNodes(c);
  std::vector<std::vector<std::uint32_t>> neighbours(c.treeCount());
  for (const LateralSpring& s : c.laterals) {
    const std::uint32_t a = treeOf[s.a], b = treeOf[s.b];
    if (a != b) neighbours[a].push_back(b), neighbours[b].push_back(a);
  }
  std::vector<std::uint32_t> colour(c.treeCount(), kNone);
  for (std::size_t t = 0; t < c.treeCount(); ++t) {
    std::vector<std::uint32_t> used;
    for (const std::uint32_t n : neighbours[t]) used.push_back(colour[n]);
    std::ranges::sort(used);
    std::uint32_t free = 0;
    for (const std::uint32_t u : used) free += u == free;
    colour[t] = free;
  }
  return colour;
}

void fillSlots(ChainBin& bin) {
  std::vector<int> children(bin.parents.size(), 0);
  for (std::size_t i = 1; i < bin.parents.size(); ++i) ++children[std::size_t(bin.parents[i])];
  bin.slots.assign(bin.parents.size(), -1);
  for (std::size_t i = 0; i < children.size(); ++i) {
    if (children[i] > 1) bin.slots[i] = bin.slotCount++;
  }
}

}  // namespace

std::vector<std::uint32_t> treeOfNodes(const ChainSet& chains) {
  std::vector<std::uint32_t> treeOf(chains.nodeCount());
  for (std::uint32_t t = 0; t < chains.treeCount(); ++t) {
    std::fill(treeOf.begin() + chains.treeOffsets[t], treeOf.begin() + chains.treeOffsets[t + 1], t);
  }
  return treeOf;
}

std::vector<ChainBin> binChains(const ChainSet& c, bool skipBending) {
  // Rest directions closer to the link than this are straight: to rounding of the builders.
  constexpr double kStraight = 1e-12;
  const std::vector<std::uint32_t> colour = colours(c);
  std::map<Key, std::vector<std::uint32_t>> bins;
  for (std::uint32_t t = 0; t < c.treeCount(); ++t) {
    const std::uint32_t begin = c.treeOffsets[t], end = c.treeOffsets[t + 1];
    bool bend = !skipBending, curved = false;
    for (std::uint32_t i = begin + 1; i < end; ++i) {
      bend |= c.stiffness[i] > 0;
      curved |= c.parents[i] != begin && (c.restDirections[i] - Vec3::UnitZ()).norm() > kStraight;
    }
    bins[{colour[t], shapeOf(c, t), bend, bend && curved, c.freeRoots[t] != 0}].push_back(t);
  }
  std::vector<ChainBin> out;
  for (auto& [key, trees] : bins) {
    ChainBin bin;
    std::tie(bin.colour, bin.parents, bin.bend, bin.curved, bin.anyFree) = key;
    bin.trees = std::move(trees);
    fillSlots(bin);
    out.push_back(std::move(bin));
  }
  return out;
}

}  // namespace coif
