#include "root_offsets.h"

#include <algorithm>

#include "coif/base/random.h"

namespace coif {
namespace {

/// Bundles around each vertex of layer 0: bundles of vertex v are list[starts[v] … starts[v + 1]).
struct Stars {
  std::vector<std::uint32_t> starts, list;
};

Stars rootStars(const HairMesh& mesh) {
  Stars stars;
  stars.starts.assign(mesh.vertices().size() + 1, 0);
  for (const Bundle& bundle : mesh.bundles()) {
    for (const std::uint32_t v : bundle.face(0)) ++stars.starts[v + 1];
  }
  for (std::size_t v = 0; v + 1 < stars.starts.size(); ++v) stars.starts[v + 1] += stars.starts[v];
  stars.list.resize(stars.starts.back());
  std::vector<std::uint32_t> next(stars.starts.begin(), stars.starts.end() - 1);
  for (std::uint32_t b = 0; b < mesh.bundles().size(); ++b) {
    for (const std::uint32_t v : mesh.bundles()[b].face(0)) stars.list[next[v]++] = b;
  }
  return stars;
}

}  // namespace

std::vector<double> rootOffsets(const HairMesh& mesh, std::uint64_t seed) {
  const auto bundles = mesh.bundles();
  const Stars stars = rootStars(mesh);
  std::vector<double> value(bundles.size()), ranked(bundles.size());
  for (std::size_t b = 0; b < bundles.size(); ++b) {
    value[b] = CounterRandom(seed, std::uint64_t(bundles[b].id)).uniform(3);
  }
  std::vector<std::uint32_t> ring;
  for (std::uint64_t pass = 0; pass < 2; ++pass) {
    for (std::uint32_t b = 0; b < bundles.size(); ++b) {
      ring.clear();
      for (const std::uint32_t v : bundles[b].face(0)) {
        ring.insert(ring.end(), stars.list.begin() + stars.starts[v],
                    stars.list.begin() + stars.starts[v + 1]);
      }
      std::sort(ring.begin(), ring.end());
      ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
      const auto below =
          std::count_if(ring.begin(), ring.end(), [&](std::uint32_t o) { return value[o] < value[b]; });
      const double within = CounterRandom(seed, std::uint64_t(bundles[b].id)).uniform(4 + pass);
      ranked[b] = (double(below) + within) / double(ring.size());
    }
    value.swap(ranked);
  }
  return value;
}

}  // namespace coif
