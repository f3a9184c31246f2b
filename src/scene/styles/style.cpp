#include "scene/styles/style.h"

#include <algorithm>
#include <map>

#include "coif/base/parallel.h"
#include "coif/hairmesh/operations.h"

namespace coif::styles {

Result<HairMesh> rootLayer(const StyleInput& input) {
  return HairMesh::fromRoot(input.cage.positions, input.cage.faceOffsets, input.cage.corners);
}

std::vector<Root> rootsOf(const HairMesh& mesh, const StyleInput& input) {
  std::size_t count = 0;
  while (count < mesh.vertices().size() && mesh.vertices()[count].layer == 0) ++count;
  std::vector<Root> roots(count);
  double lo = 1e300, hi = -1e300;
  for (std::size_t v = 0; v < count; ++v) {
    const Vec3& scene = mesh.vertices()[v].position;
    roots[v].point = input.space.fromScene(scene);
    roots[v].normal = input.space.directionFromScene(input.head.nearest(scene).normal).normalized();
    lo = std::min(lo, roots[v].point.y()), hi = std::max(hi, roots[v].point.y());
  }
  for (Root& root : roots) root.rank = hi > lo ? (root.point.y() - lo) / (hi - lo) : 1;
  return roots;
}

Status extrudeLayers(HairMesh& mesh, std::span<const BundleId> bundles, std::uint32_t layers) {
  ExtrudeOptions onTheSpot;
  onTheSpot.direction = Vec3::Zero();  // targets follow
  for (std::uint32_t layer = 0; layer < layers; ++layer) {
    if (auto made = extrudeFaces(mesh, bundles, onTheSpot); !made.ok()) return made.error();
  }
  return {};
}

std::vector<Vec3> targetsOf(const HairMesh& mesh, const StyleInput& input, const std::vector<int>& sides,
                            const GuideMaker& guide) {
  const auto roots = rootsOf(mesh, input);
  const auto ancestors = rootAncestors(mesh);
  std::vector<std::uint32_t> tops(mesh.vertices().size(), 0);  // height of the highest column through the vertex
  for (const Bundle& bundle : mesh.bundles()) {
    for (std::uint32_t v : bundle.vertices) tops[v] = std::max(tops[v], bundle.height());
  }
  // One guide a root, side and column height; several vertices share each.
  using Key = std::tuple<std::uint32_t, int, std::uint32_t>;
  std::map<Key, Guide> guides;
  for (std::uint32_t v = 0; v < ancestors.size(); ++v) {
    if (mesh.vertices()[v].layer > 0) guides[{ancestors[v], sides[v], tops[v]}];
  }
  std::vector<std::pair<const Key, Guide>*> work;
  for (auto& entry : guides) work.push_back(&entry);
  parallelFor(input.context, work.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto& [root, side, top] = work[i]->first;
      Root at = roots[root];
      at.side = side;
      Guide made = guide(at);
      work[i]->second = made.size() == top + 1 ? std::move(made) : resample(made, top + 1);
    }
  });
  std::vector<Vec3> targets(ancestors.size());
  for (std::uint32_t v = 0; v < targets.size(); ++v) {
    const HairVertex& vertex = mesh.vertices()[v];
    targets[v] = vertex.layer == 0
                     ? vertex.position
                     : input.space.toScene(guides.at({ancestors[v], sides[v], tops[v]})[vertex.layer]);
  }
  return targets;
}

Result<std::size_t> separateParting(HairMesh& mesh, const StyleInput& input, double back) {
  // The root layer's vertices are the cage's: all of them carry faces, so fromRoot keeps their order.
  const auto onParting = [&](std::uint32_t v) {
    if (input.space.fromScene(mesh.position(v)).z() < back) return false;
    if (!input.cage.grid.empty()) return input.cage.grid[v][0] == input.cage.columns / 2;
    return !input.cage.onPlane.empty() && input.cage.onPlane[v] != 0;
  };
  std::size_t count = 0;
  const std::size_t bundles = mesh.bundles().size();
  for (std::size_t j = 0; j < bundles; ++j) {
    const Bundle bundle = mesh.bundles()[j];
    for (std::uint32_t side = 0; side < bundle.corners; ++side) {
      const auto root = bundle.face(0);
      if (!onParting(root[side]) || !onParting(root[(side + 1) % bundle.corners])) continue;
      // Each edge comes up from both its bundles; the second finds it separated already.
      if (separateEdge(mesh, {bundle.id, 1, side}).ok()) ++count;
    }
  }
  return count;
}

}  // namespace coif::styles
