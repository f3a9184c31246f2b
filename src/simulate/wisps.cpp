#include <cmath>

#include "coif/simulate/chain.h"

namespace coif {

namespace {

// Walks first children only: in depth-first order a plain chain is a run of nodes.
Vec3 pointAt(const ChainSet& c, std::span<const Vec3> x, std::uint32_t tree, double fraction) {
  const std::uint32_t begin = c.treeOffsets[tree];
  std::uint32_t end = begin + 1;
  double total = 0;
  for (; end < c.treeOffsets[tree + 1] && c.parents[end] == end - 1; ++end) total += c.lengths[end];
  double left = fraction * total;
  for (std::uint32_t i = begin + 1; i < end; ++i) {
    if (left <= c.lengths[i] || i + 1 == end) {
      const double s = std::min(1.0, left / c.lengths[i]);
      return x[i - 1] + s * (x[i] - x[i - 1]);
    }
    left -= c.lengths[i];
  }
  return x[begin];
}

}  // namespace

Status interpolateWisps(const ChainSet& chains, std::span<const Vec3> positions,
                        std::span<const WispStrand> strands, std::size_t pointsPerStrand,
                        std::span<Vec3f> out) {
  if (positions.size() != chains.nodeCount() || pointsPerStrand < 2 ||
      out.size() != strands.size() * pointsPerStrand)
    return makeError(ErrorCode::InvalidArgument, "sizes of positions, points a strand and output do not fit");
  for (std::size_t s = 0; s < strands.size(); ++s) {
    for (const std::uint32_t tree : strands[s].trees) {
      if (tree >= chains.treeCount())
        return makeError(ErrorCode::InvalidArgument, "a wisp names a chain that does not exist",
                         "strand " + std::to_string(s));
    }
    for (std::size_t p = 0; p < pointsPerStrand; ++p) {
      Vec3 sum = Vec3::Zero();
      for (int g = 0; g < 3; ++g) {
        const double fraction = double(p) / double(pointsPerStrand - 1);
        sum += strands[s].weights[g] * pointAt(chains, positions, strands[s].trees[g], fraction);
      }
      out[s * pointsPerStrand + p] = sum.cast<float>();
    }
  }
  return {};
}

}  // namespace coif
