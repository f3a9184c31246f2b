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

std::vector<Vec3> targetsOf(const HairMesh& mesh, const StyleInput& input, const std::vector<Lie>& lies,
                            const GuideMaker& guide) {
  const auto roots = rootsOf(mesh, input);
  const auto ancestors = rootAncestors(mesh);
  std::vector<std::uint32_t> tops(mesh.vertices().size(),
                                  0);  // height of the highest column through the vertex
  for (const Bundle& bundle : mesh.bundles()) {
    for (std::uint32_t v : bundle.vertices) tops[v] = std::max(tops[v], bundle.height());
  }
  // One guide a root, lie and column height; several vertices share each.
  using Key = std::tuple<std::uint32_t, int, int, std::uint32_t>;
  const auto keyOf = [&](std::uint32_t v) { return Key(ancestors[v], lies[v].side, lies[v].depth, tops[v]); };
  std::map<Key, Guide> guides;
  for (std::uint32_t v = 0; v < ancestors.size(); ++v) {
    if (mesh.vertices()[v].layer > 0) guides[keyOf(v)];
  }
  std::vector<std::pair<const Key, Guide>*> work;
  for (auto& entry : guides) work.push_back(&entry);
  parallelFor(input.context, work.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto& [root, side, depth, top] = work[i]->first;
      Root at = roots[root];
      at.lie = {side, depth};
      Guide made = guide(at);
      work[i]->second = made.size() == top + 1 ? std::move(made) : resample(made, top + 1);
    }
  });
  std::vector<Vec3> targets(ancestors.size());
  for (std::uint32_t v = 0; v < targets.size(); ++v) {
    const HairVertex& vertex = mesh.vertices()[v];
    targets[v] = vertex.layer == 0 ? vertex.position : input.space.toScene(guides.at(keyOf(v))[vertex.layer]);
  }
  return targets;
}

Vec3 middleOf(const HairMesh& mesh, const StyleInput& input, const Bundle& bundle) {
  Vec3 sum = Vec3::Zero();
  for (std::uint32_t v : bundle.face(0)) sum += input.space.fromScene(mesh.position(v));
  return sum / double(bundle.corners);
}

std::size_t separateBetween(HairMesh& mesh, const StyleInput& input, const BundleSide& negative,
                            std::uint32_t layer, const std::function<bool(const Vec3&)>& along) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, bool> kinds;  // of the first bundle on each root edge
  std::vector<EdgeRef> line;
  for (const Bundle& bundle : mesh.bundles()) {
    const auto root = bundle.face(0);
    const bool here = negative(bundle);
    for (std::uint32_t side = 0; side < bundle.corners; ++side) {
      const std::uint32_t a = root[side], b = root[(side + 1) % bundle.corners];
      if (!along(input.space.fromScene(mesh.position(a))) || !along(input.space.fromScene(mesh.position(b))))
        continue;
      const auto [it, first] = kinds.try_emplace(std::minmax(a, b), here);
      if (!first && it->second != here) line.push_back({bundle.id, layer, side});
    }
  }
  std::size_t count = 0;
  for (const EdgeRef& edge : line) count += separateEdge(mesh, edge).ok();
  return count;
}

}  // namespace coif::styles
