#include "connectivity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <unordered_map>

#include "coif/base/random.h"

namespace coif {

EdgeTable buildEdges(std::span<const std::uint32_t> faceOffsets, std::span<const std::uint32_t> corners) {
  EdgeTable table;
  table.uses.reserve(corners.size());
  for (std::uint32_t f = 0; f + 1 < faceOffsets.size(); ++f)
    for (std::uint32_t c = faceOffsets[f]; c < faceOffsets[f + 1]; ++c) {
      const std::uint32_t next = c + 1 < faceOffsets[f + 1] ? c + 1 : faceOffsets[f];
      const std::uint32_t a = corners[c], b = corners[next];
      if (a != b) table.uses.push_back({std::min(a, b), std::max(a, b), f, c, next, a < b});
    }
  std::sort(table.uses.begin(), table.uses.end(), [](const EdgeUse& x, const EdgeUse& y) {
    return std::tie(x.a, x.b, x.corner) < std::tie(y.a, y.b, y.corner);
  });
  for (std::uint32_t i = 1; i <= table.uses.size(); ++i)
    if (i == table.uses.size() || table.uses[i].a != table.uses[i - 1].a ||
        table.uses[i].b != table.uses[i - 1].b)
      table.offsets.push_back(i);
  return table;
}

DisjointSets cornerFans(const EdgeTable& edges, std::size_t cornerCount) {
  DisjointSets fans(cornerCount);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto uses = edges.edge(e);
    for (std::size_t i = 1; i < uses.size(); ++i) {
      const EdgeUse &x = uses[0], &y = uses[i];
      fans.join(x.forward ? x.corner : x.nextCorner, y.forward ? y.corner : y.nextCorner);
      fans.join(x.forward ? x.nextCorner : x.corner, y.forward ? y.nextCorner : y.corner);
    }
  }
  return fans;
}

namespace {

using Cell = std::array<std::int64_t, 3>;
struct CellHash {
  std::size_t operator()(const Cell& c) const {
    return hashCombine(hashCombine(std::uint64_t(c[0]), std::uint64_t(c[1])), std::uint64_t(c[2]));
  }
};

std::vector<std::uint32_t> equalRepresentatives(std::span<const Vec3> positions) {
  std::vector<std::uint32_t> order(positions.size()), lowest(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  lowest = order;
  std::erase_if(order, [&](std::uint32_t v) { return !positions[v].allFinite(); });
  const auto key = [&](std::uint32_t v) {
    return std::tuple(positions[v].x(), positions[v].y(), positions[v].z());
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const auto ka = key(a), kb = key(b);
    return ka < kb || (ka == kb && a < b);
  });
  for (std::size_t i = 1; i < order.size(); ++i)
    if (key(order[i]) == key(order[i - 1])) lowest[order[i]] = lowest[order[i - 1]];
  return lowest;
}

}  // namespace

std::vector<std::uint32_t> coincidentRepresentatives(std::span<const Vec3> positions, double tolerance) {
  std::vector<std::uint32_t> lowest = equalRepresentatives(positions);
  std::vector<Vec3> finite;
  for (const Vec3& p : positions)
    if (p.allFinite()) finite.push_back(p);
  const Box box = bounds(finite);
  // A cell must be coarser than the coordinates' own rounding, or its number would overflow.
  const double cell = std::max(tolerance, box.diagonal() * 0x1.0p-50);
  if (!(tolerance > 0) || !std::isfinite(cell)) return lowest;
  std::unordered_map<Cell, std::vector<std::uint32_t>, CellHash> grid;  // looked up only, never iterated
  for (std::uint32_t v = 0; v < positions.size(); ++v) {
    if (lowest[v] != v) {
      lowest[v] = lowest[lowest[v]];
      continue;
    }
    if (!positions[v].allFinite()) continue;
    const Vec3 scaled = (positions[v] - box.lo) / cell;
    const Cell home{std::int64_t(scaled.x()), std::int64_t(scaled.y()), std::int64_t(scaled.z())};
    std::uint32_t found = kNone;
    for (int k = 0; k < 27; ++k) {
      const auto it = grid.find({home[0] + k % 3 - 1, home[1] + k / 3 % 3 - 1, home[2] + k / 9 - 1});
      if (it == grid.end()) continue;
      for (std::uint32_t r : it->second)
        if (r < found && (positions[r] - positions[v]).norm() <= tolerance) found = r;
    }
    if (found != kNone) {
      lowest[v] = found;
    } else {
      grid[home].push_back(v);
    }
  }
  // An exact twin of a vertex that joined another follows it; it stays within the tolerance.
  for (std::uint32_t v = 0; v < positions.size(); ++v) lowest[v] = lowest[lowest[v]];
  return lowest;
}

std::vector<std::uint32_t> faceShells(std::span<const std::uint32_t> faceOffsets,
                                      std::span<const std::uint32_t> corners, std::size_t vertexCount) {
  DisjointSets sets(vertexCount);
  for (std::size_t f = 0; f + 1 < faceOffsets.size(); ++f)
    for (std::uint32_t c = faceOffsets[f] + 1; c < faceOffsets[f + 1]; ++c)
      sets.join(corners[faceOffsets[f]], corners[c]);
  std::vector<std::uint32_t> number(vertexCount, kNone), shells;
  std::uint32_t count = 0;
  for (std::size_t f = 0; f + 1 < faceOffsets.size(); ++f) {
    std::uint32_t& n = number[sets.find(corners[faceOffsets[f]])];
    if (n == kNone) n = count++;
    shells.push_back(n);
  }
  return shells;
}

}  // namespace coif
