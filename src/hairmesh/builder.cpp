#include "hairmesh/builder.h"

#include <algorithm>

#include "hairmesh/checks.h"

namespace coif {

using hairmesh::SmallSets;
using hairmesh::Topology;

Result<HairMeshBuilder> HairMeshBuilder::from(const HairMesh& mesh) {
  HairMeshBuilder builder;
  builder.vertices = mesh.vertices_;
  builder.bundles = mesh.bundles_;
  builder.groupNames_ = mesh.groupNames_;
  builder.nextVertexId_ = mesh.nextVertexId_;
  builder.nextBundleId_ = mesh.nextBundleId_;
  COIF_ASSIGN(builder.topology, Topology::build(mesh.vertices_.size(), mesh.bundles_, mesh.splits_));
  return builder;
}

std::uint32_t HairMeshBuilder::addVertex(const Vec3& position, std::uint32_t parent, std::uint32_t layer,
                                         bool pinned) {
  vertices.push_back({VertexId(nextVertexId_++), position, parent, layer, pinned, false});
  return std::uint32_t(vertices.size()) - 1;
}

std::uint32_t HairMeshBuilder::addBundle(std::uint32_t corners, std::uint32_t group,
                                         std::vector<std::uint32_t> rows) {
  bundles.push_back({BundleId(nextBundleId_++), corners, group, std::move(rows)});
  return std::uint32_t(bundles.size()) - 1;
}

void HairMeshBuilder::regroup(std::uint32_t rootVertex, std::uint32_t fromLayer, Welds welds) {
  const auto corners = topology.around(rootVertex);
  const std::uint32_t n = std::uint32_t(corners.size());
  std::uint32_t top = 0;  // one past the highest layer here
  for (const std::uint32_t c : corners) top = std::max(top, layers(topology.bundleOf(c)));
  const auto reaches = [&](std::uint32_t i, std::uint32_t k) {
    return k < layers(topology.bundleOf(corners[i]));
  };

  // Downwards: what hangs together on each layer.
  std::vector<std::vector<std::uint32_t>> labels(top);
  SmallSets sets;
  for (std::uint32_t k = top; k-- > fromLayer;) {
    sets.reset(n);
    std::vector<std::uint32_t> fans;
    hairmesh::fanLabels(topology, bundles, rootVertex, k, fans);
    for (std::uint32_t i = 0; i < n; ++i) {
      if (!reaches(i, k)) continue;
      sets.unite(i, fans[i]);
      for (std::uint32_t j = 0; j < i; ++j) {
        if (!reaches(j, k)) continue;
        const bool held =
            at(corners[i], k) == at(corners[j], k) && vertices[at(corners[i], k)].welded && k > 0;
        const bool heldAbove = welds == Welds::Hold && k > 0 && k + 1 < top && reaches(i, k + 1) &&
                               reaches(j, k + 1) && labels[k + 1][i] == labels[k + 1][j];
        if (held || heldAbove) sets.unite(i, j);
        if (heldAbove && fans[i] != fans[j]) vertices[at(corners[i], k)].welded = true;
      }
    }
    labels[k].resize(n);
    for (std::uint32_t i = 0; i < n; ++i) labels[k][i] = sets.find(i);
  }

  // Upwards: no group is wider than its parent's; the first keeps the vertex, the others get copies.
  for (std::uint32_t k = fromLayer; k < top; ++k) {
    struct Group {
      std::uint32_t parent, label, old, vertex;
    };
    std::vector<Group> groups;
    for (std::uint32_t i = 0; i < n; ++i) {
      if (!reaches(i, k)) continue;
      const std::uint32_t parent = k == 0 ? kNone : at(corners[i], k - 1);
      std::uint32_t& vertex = at(corners[i], k);
      const auto same = [&](const Group& g) {
        return g.parent == parent && g.label == labels[k][i] && g.old == vertex;
      };
      auto group = std::find_if(groups.begin(), groups.end(), same);
      if (group == groups.end()) {
        const bool kept =
            std::none_of(groups.begin(), groups.end(), [&](const Group& g) { return g.old == vertex; });
        const HairVertex old = vertices[vertex];
        rootChanged_ = rootChanged_ || (!kept && k == 0);
        const std::uint32_t fresh = kept ? vertex : addVertex(old.position, parent, k, old.pinned);
        vertices[fresh].parent = parent;
        vertices[fresh].welded = old.welded;
        groups.push_back({parent, labels[k][i], vertex, fresh});
        group = groups.end() - 1;
      }
      vertex = group->vertex;
    }
  }
}

std::vector<EdgeSplit> HairMeshBuilder::splits() const {
  std::vector<EdgeSplit> result;
  for (std::uint32_t side = 0; side < topology.sideCount(); ++side) {
    const std::uint32_t other = topology.opposite(side), layer = topology.split(side);
    if (other == kNone || other < side || layer == kNone) continue;
    const Bundle& bundle = bundles[topology.bundleOf(side)];
    const std::uint32_t lower = std::min(hairmesh::layerCountOf(bundle), layers(topology.bundleOf(other)));
    if (layer >= lower) continue;
    const std::uint32_t a = bundle.vertices[topology.cornerOf(side)];
    const std::uint32_t b = bundle.vertices[topology.cornerOf(topology.next(side))];
    result.push_back({std::min(a, b), std::max(a, b), layer});
  }
  std::sort(result.begin(), result.end());
  return result;
}

Status HairMeshBuilder::retopologise(const std::vector<EdgeSplit>& splits) {
  std::erase_if(bundles, [](const Bundle& bundle) { return bundle.vertices.empty(); });
  rootChanged_ = true;
  COIF_ASSIGN(topology, Topology::build(vertices.size(), bundles, splits));
  return {};
}

void HairMeshBuilder::compact() {
  if (std::erase_if(bundles, [](const Bundle& bundle) { return bundle.vertices.empty(); }) > 0)
    rootChanged_ = true;
  std::vector<std::uint32_t> index(vertices.size(), kNone);
  for (const Bundle& bundle : bundles) {
    for (const std::uint32_t v : bundle.vertices) index[v] = 0;
  }
  std::uint32_t count = 0;
  for (std::uint32_t v = 0; v < vertices.size(); ++v) {
    if (index[v] == kNone) continue;
    index[v] = count;
    vertices[count++] = vertices[v];
  }
  vertices.resize(count);
  for (HairVertex& vertex : vertices) {
    if (vertex.parent != kNone) vertex.parent = index[vertex.parent];
  }
  for (Bundle& bundle : bundles) {
    for (std::uint32_t& v : bundle.vertices) v = index[v];
  }
}

void HairMeshBuilder::clearSingleFanWelds() {
  std::vector<std::uint32_t> fans;
  for (std::uint32_t v = 0; v < vertices.size(); ++v) {
    if (!vertices[v].welded) continue;
    std::uint32_t root = v;
    while (vertices[root].parent != kNone) root = vertices[root].parent;
    const std::uint32_t layer = vertices[v].layer;
    hairmesh::fanLabels(topology, bundles, root, layer, fans);
    const auto corners = topology.around(root);
    std::uint32_t first = kNone;
    bool several = false;
    for (std::uint32_t i = 0; i < corners.size(); ++i) {
      if (fans[i] == kNone || at(corners[i], layer) != v) continue;
      if (first == kNone) first = fans[i];
      several = several || fans[i] != first;
    }
    vertices[v].welded = several;
  }
}

Status HairMeshBuilder::commit(HairMesh& mesh) {
  HairMesh result;
  result.splits_ = splits();
  // Splits name vertices by index: translate them over the compaction by way of the ids, which it keeps.
  std::vector<VertexId> ends;
  for (const EdgeSplit& split : result.splits_)
    ends.insert(ends.end(), {vertices[split.a].id, vertices[split.b].id});
  compact();
  const auto indexOf = [&](VertexId id) {
    const auto at = std::lower_bound(vertices.begin(), vertices.end(), id,
                                     [](const HairVertex& v, VertexId wanted) { return v.id < wanted; });
    return std::uint32_t(at - vertices.begin());
  };
  for (std::size_t i = 0; i < result.splits_.size(); ++i) {
    result.splits_[i].a = indexOf(ends[2 * i]);
    result.splits_[i].b = indexOf(ends[2 * i + 1]);
  }
  if (rootChanged_) {
    COIF_TRY(retopologise(result.splits_));
  } else {
    COIF_TRY(topology.renumber(vertices.size(), bundles, result.splits_));
  }
  clearSingleFanWelds();
  result.vertices_ = std::move(vertices);
  result.bundles_ = std::move(bundles);
  result.groupNames_ = groupNames_;
  result.nextVertexId_ = nextVertexId_;
  result.nextBundleId_ = nextBundleId_;
  const auto faults = hairmesh::checkWithTopology(result, &topology);
  if (!faults.empty()) {
    return makeError(ErrorCode::Degenerate,
                     "the operation would break the mesh (" + faults[0].name + "): " + faults[0].message,
                     faults[0].element);
  }
  mesh = std::move(result);
  return {};
}

HairMesh HairMeshBuilder::restore(std::vector<HairVertex> vertices, std::vector<Bundle> bundles,
                                  std::vector<EdgeSplit> splits, std::vector<std::string> groupNames,
                                  std::uint32_t nextVertexId, std::uint32_t nextBundleId) {
  HairMesh mesh;
  mesh.vertices_ = std::move(vertices);
  mesh.bundles_ = std::move(bundles);
  mesh.splits_ = std::move(splits);
  mesh.groupNames_ = std::move(groupNames);
  mesh.nextVertexId_ = nextVertexId;
  mesh.nextBundleId_ = nextBundleId;
  return mesh;
}

Result<HairMesh> HairMeshBuilder::assemble(std::vector<HairVertex> vertices, std::vector<Bundle> bundles,
                                           std::vector<EdgeSplit> splits, std::vector<std::string> groupNames,
                                           std::uint32_t nextVertexId, std::uint32_t nextBundleId) {
  HairMesh mesh = restore(std::move(vertices), std::move(bundles), std::move(splits), std::move(groupNames),
                          nextVertexId, nextBundleId);
  const auto faults = checkInvariants(mesh);
  if (!faults.empty()) {
    return makeError(faults[0].name == "root" ? ErrorCode::Degenerate : ErrorCode::InvalidArgument,
                     faults[0].name + ": " + faults[0].message, faults[0].element);
  }
  return mesh;
}

}  // namespace coif
