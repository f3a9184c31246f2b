#include "bench/dynamics_problem.h"

#include <algorithm>

namespace coif {

ChainSet straightChain(std::size_t links, double length, const Vec3& direction, double mass, double kappa) {
  std::vector<Vec3> points;
  for (std::size_t i = 0; i <= links; ++i)
    points.push_back(direction.normalized() * (length * double(i) / double(links)));
  const std::vector<std::uint64_t> offsets{0, points.size()};
  ChainSet chains = chainsFromCurves(points, offsets).value().chains;
  std::ranges::fill(chains.masses, mass);
  std::ranges::fill(chains.stiffness, kappa);
  return chains;
}

ChainSet repeated(const ChainSet& one, std::size_t count) {
  ChainSet all = one;
  all.laterals.clear();
  all.sources.clear();
  const auto repeat = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  for (std::size_t k = 1; k < count; ++k) {
    const auto base = std::uint32_t(all.nodeCount());
    for (const std::uint32_t p : one.parents) all.parents.push_back(p == kNone ? kNone : p + base);
    for (std::size_t t = 0; t < one.treeCount(); ++t)
      all.treeOffsets.push_back(base + one.treeOffsets[t + 1]);
    repeat(all.lengths, one.lengths), repeat(all.restDirections, one.restDirections);
    repeat(all.stiffness, one.stiffness), repeat(all.masses, one.masses), repeat(all.drags, one.drags);
    repeat(all.radii, one.radii), repeat(all.restPositions, one.restPositions);
    repeat(all.rootFrames, one.rootFrames), repeat(all.freeRoots, one.freeRoots);
  }
  return all;
}

}  // namespace coif
