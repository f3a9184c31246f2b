#include "style/locks.h"

#include <algorithm>
#include <map>

#include "coif/base/parallel.h"

namespace coif::style {
namespace {

using Lists = std::vector<std::vector<std::uint32_t>>;

/// Bundles that share a root edge which is nowhere separated.
Lists neighbours(const HairMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> first;
  Lists out(mesh.bundles().size());
  for (std::uint32_t b = 0; b < mesh.bundles().size(); ++b) {
    const auto face = mesh.bundles()[b].face(0);
    for (std::size_t i = 0; i < face.size(); ++i) {
      const auto edge = std::minmax(face[i], face[(i + 1) % face.size()]);
      const auto [known, isNew] = first.try_emplace({edge.first, edge.second}, b);
      if (isNew) continue;
      const EdgeSplit asked{edge.first, edge.second, 0};
      const auto split = std::ranges::lower_bound(mesh.splits(), asked);
      if (split != mesh.splits().end() && split->a == asked.a && split->b == asked.b) continue;
      out[b].push_back(known->second), out[known->second].push_back(b);
    }
  }
  return out;
}

/// Centres in the rings of bundles around `start`: up to where a nearer one can be. On a grid of quads ring r
/// holds places up to r√2 farther along a diagonal than along a row.
std::vector<std::uint32_t> candidates(std::uint32_t start, const Lists& around, const Lists& centresIn,
                                      std::vector<std::uint32_t>& seen) {
  std::vector<std::uint32_t> out, ring{start}, next;
  seen[start] = start;
  std::size_t last = ~std::size_t{0};
  for (std::size_t r = 0; !ring.empty() && r <= last; ++r) {
    next.clear();
    for (const std::uint32_t b : ring) {
      out.insert(out.end(), centresIn[b].begin(), centresIn[b].end());
      for (const std::uint32_t n : around[b]) {
        if (seen[n] != start) seen[n] = start, next.push_back(n);
      }
    }
    if (!out.empty() && last == ~std::size_t{0}) last = (3 * r + 1) / 2 + 2;
    std::swap(ring, next);
  }
  return out;
}

}  // namespace

LockChoice chooseLocks(const HairMesh& mesh, const Embedding& embedding, std::uint32_t count,
                       std::uint32_t group, const Context& context) {
  const std::size_t bundles = mesh.bundles().size(), strands = embedding.bundles.size();
  LockChoice out;
  out.centreOf.assign(strands, kNone);
  Lists strandsIn(bundles), centresIn(bundles);
  for (std::uint32_t s = 0; s < strands; ++s) {
    const std::uint32_t b = embedding.bundles[s];
    if (group != kNone && mesh.bundles()[b].group != group) continue;
    strandsIn[b].push_back(s);
    if (out.centres.size() == count) continue;
    centresIn[b].push_back(std::uint32_t(out.centres.size()));
    out.centres.push_back(s);
  }
  const Lists around = neighbours(mesh);
  parallelFor(context, bundles, 64, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> seen(bundles, kNone);
    for (std::size_t b = begin; b < end; ++b) {
      if (strandsIn[b].empty()) continue;
      const auto near = candidates(std::uint32_t(b), around, centresIn, seen);
      for (const std::uint32_t s : strandsIn[b]) {
        double best = 0;
        for (const std::uint32_t c : near) {
          const double d = (embedding.places[out.centres[c]].root - embedding.places[s].root).squaredNorm();
          std::uint32_t& chosen = out.centreOf[s];
          if (chosen == kNone || d < best || (d == best && c < chosen)) best = d, chosen = c;
        }
      }
    }
  });
  return out;
}

}  // namespace coif::style
