#include "coif/hairmesh/hair_mesh.h"

#include <algorithm>

#include "coif/base/check.h"
#include "hairmesh/builder.h"

namespace coif {
namespace {

using hairmesh::SmallSets;
using hairmesh::Topology;

Status validateRoot(std::span<const Vec3> positions, std::span<const std::uint32_t> offsets,
                    std::span<const std::uint32_t> corners) {
  const auto bad = [](std::string message, std::string place) {
    return makeError(ErrorCode::InvalidArgument, std::move(message), std::move(place));
  };
  if (offsets.empty() || offsets.front() != 0 || offsets.back() != corners.size()) {
    return bad("the face offsets do not span the corners", "offsets");
  }
  for (std::size_t f = 0; f + 1 < offsets.size(); ++f) {
    const std::string place = "face " + std::to_string(f);
    if (offsets[f + 1] < offsets[f] || offsets[f + 1] > corners.size()) {
      return bad("the face offsets descend", place);
    }
    const auto face = corners.subspan(offsets[f], offsets[f + 1] - offsets[f]);
    if (face.size() < 3) return bad("the face has fewer than three corners", place);
    std::vector<std::uint32_t> sorted(face.begin(), face.end());
    std::sort(sorted.begin(), sorted.end());
    if (sorted.back() >= positions.size()) return bad("a corner names a vertex that does not exist", place);
    if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) {
      return bad("the face has a vertex twice", place);
    }
    for (const std::uint32_t v : face) {
      if (!positions[v].allFinite()) return bad("a position is not finite", "vertex " + std::to_string(v));
    }
  }
  return {};
}

/// One side of an input face, for sorting by its edge.
struct InputSide {
  std::uint32_t a, b, corner, nextCorner;  // a < b
  bool forward;
  std::uint32_t face;
};

Result<std::vector<InputSide>> sortedSides(std::span<const std::uint32_t> offsets,
                                           std::span<const std::uint32_t> corners) {
  std::vector<InputSide> sides;
  sides.reserve(corners.size());
  for (std::uint32_t f = 0; f + 1 < offsets.size(); ++f) {
    for (std::uint32_t c = offsets[f]; c < offsets[f + 1]; ++c) {
      const std::uint32_t n = c + 1 == offsets[f + 1] ? offsets[f] : c + 1;
      sides.push_back({std::min(corners[c], corners[n]), std::max(corners[c], corners[n]), c, n,
                       corners[c] < corners[n], f});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const InputSide& x, const InputSide& y) {
    return std::tie(x.a, x.b, x.corner) < std::tie(y.a, y.b, y.corner);
  });
  for (std::size_t i = 1; i < sides.size(); ++i) {
    if (sides[i].a != sides[i - 1].a || sides[i].b != sides[i - 1].b) continue;
    const bool third = i >= 2 && sides[i].a == sides[i - 2].a && sides[i].b == sides[i - 2].b;
    if (!third && sides[i].forward != sides[i - 1].forward) continue;
    return makeError(
        ErrorCode::Degenerate,
        third ? "an edge of the face has three or more faces" : "two faces run along an edge the same way",
        "face " + std::to_string(sides[i].face));
  }
  return sides;
}

}  // namespace

Result<HairMesh> HairMesh::fromRoot(std::span<const Vec3> positions, std::span<const std::uint32_t> offsets,
                                    std::span<const std::uint32_t> corners) {
  COIF_TRY(validateRoot(positions, offsets, corners));
  COIF_ASSIGN(const std::vector<InputSide> sides, sortedSides(offsets, corners));

  // Corners that shared edges connect are one vertex; faces that only touch get copies.
  SmallSets fans;
  fans.reset(corners.size());
  for (std::size_t i = 1; i < sides.size(); ++i) {
    if (sides[i].a != sides[i - 1].a || sides[i].b != sides[i - 1].b) continue;
    fans.unite(sides[i].corner, sides[i - 1].nextCorner);
    fans.unite(sides[i].nextCorner, sides[i - 1].corner);
  }
  std::vector<HairVertex> vertices;
  std::vector<std::uint32_t> vertexOf(corners.size(), kNone);
  const auto addVertex = [&](std::uint32_t c) {
    vertexOf[c] = std::uint32_t(vertices.size());
    vertices.push_back({VertexId(vertices.size()), positions[corners[c]], kNone, 0, false, false});
  };
  // First fans in the input's vertex order, so that a clean input keeps its numbering; then the copies.
  std::vector<std::uint32_t> firstFan(positions.size(), kNone);
  for (std::uint32_t c = 0; c < corners.size(); ++c) {
    if (firstFan[corners[c]] == kNone) firstFan[corners[c]] = fans.find(c);
  }
  for (const std::uint32_t fan : firstFan) {
    if (fan != kNone) addVertex(fan);
  }
  std::vector<Bundle> bundles;
  for (std::uint32_t f = 0; f + 1 < offsets.size(); ++f) {
    bundles.push_back({BundleId(f), offsets[f + 1] - offsets[f], 0, {}});
    for (std::uint32_t c = offsets[f]; c < offsets[f + 1]; ++c) {
      const std::uint32_t fan = fans.find(c);
      if (vertexOf[fan] == kNone) addVertex(fan);
      bundles.back().vertices.push_back(vertexOf[fan]);
    }
  }
  const std::uint32_t nextVertex = std::uint32_t(vertices.size()), nextBundle = std::uint32_t(bundles.size());
  return HairMeshBuilder::assemble(std::move(vertices), std::move(bundles), {}, {"hair"}, nextVertex,
                                   nextBundle);
}

Result<HairMesh> HairMesh::fromParts(std::vector<HairVertex> vertices, std::vector<Bundle> bundles,
                                     std::vector<EdgeSplit> splits, std::vector<std::string> groupNames,
                                     std::uint32_t nextVertexId, std::uint32_t nextBundleId) {
  return HairMeshBuilder::assemble(std::move(vertices), std::move(bundles), std::move(splits),
                                   std::move(groupNames), nextVertexId, nextBundleId);
}

std::uint32_t HairMesh::layerCount() const {
  std::uint32_t count = 0;
  for (const Bundle& bundle : bundles_) count = std::max(count, hairmesh::layerCountOf(bundle));
  return count;
}

std::uint32_t HairMesh::indexOf(VertexId id) const {
  const auto at = std::lower_bound(vertices_.begin(), vertices_.end(), id,
                                   [](const HairVertex& v, VertexId wanted) { return v.id < wanted; });
  return at != vertices_.end() && at->id == id ? std::uint32_t(at - vertices_.begin()) : kNone;
}

std::uint32_t HairMesh::indexOf(BundleId id) const {
  const auto at = std::lower_bound(bundles_.begin(), bundles_.end(), id,
                                   [](const Bundle& b, BundleId wanted) { return b.id < wanted; });
  return at != bundles_.end() && at->id == id ? std::uint32_t(at - bundles_.begin()) : kNone;
}

std::uint32_t HairMesh::addGroup(const std::string& name) {
  const auto at = std::find(groupNames_.begin(), groupNames_.end(), name);
  if (at == groupNames_.end()) {
    groupNames_.push_back(name);
    return std::uint32_t(groupNames_.size()) - 1;
  }
  return std::uint32_t(at - groupNames_.begin());
}

std::vector<SideQuad> sideQuads(const HairMesh& mesh) {
  const auto bundles = mesh.bundles();
  const auto topology = Topology::build(mesh.vertices().size(), bundles, mesh.splits());
  COIF_CHECK(topology.ok(), topology.ok() ? "" : topology.error().text());
  std::vector<SideQuad> quads;
  for (std::uint32_t j = 0; j < bundles.size(); ++j) {
    for (std::uint32_t k = 0; k + 1 < hairmesh::layerCountOf(bundles[j]); ++k) {
      const auto low = bundles[j].face(k), high = bundles[j].face(k + 1);
      for (std::uint32_t i = 0; i < bundles[j].corners; ++i) {
        const std::uint32_t side = topology->side(j, i), n = (i + 1) % bundles[j].corners;
        const bool shared = topology->joined(bundles, side, k + 1);  // and so on layer k
        if (shared && topology->opposite(side) < side) continue;
        quads.push_back({low[i], low[n], high[i], high[n], !shared});
      }
    }
  }
  return quads;
}

std::vector<std::uint8_t> externalVertices(const HairMesh& mesh) {
  const auto bundles = mesh.bundles();
  const auto topology = Topology::build(mesh.vertices().size(), bundles, mesh.splits());
  COIF_CHECK(topology.ok(), topology.ok() ? "" : topology.error().text());
  std::vector<std::uint8_t> external(mesh.vertices().size(), 0);
  for (std::size_t v = 0; v < external.size(); ++v) {
    external[v] = mesh.vertices()[v].layer == 0 || mesh.vertices()[v].pinned;
  }
  for (std::uint32_t j = 0; j < bundles.size(); ++j) {
    const std::uint32_t height = bundles[j].height();
    for (const std::uint32_t v : bundles[j].face(height)) external[v] = 1;
    for (std::uint32_t k = 0; k <= height; ++k) {
      const auto face = bundles[j].face(k);
      for (std::uint32_t i = 0; i < bundles[j].corners; ++i) {
        // An exposed quad between k and k + 1 has a boundary edge above, and its lower edge counts as well.
        const std::uint32_t side = topology->side(j, i), above = std::min(k + 1, height);
        if (topology->joined(bundles, side, k) && topology->joined(bundles, side, above)) continue;
        external[face[i]] = external[face[(i + 1) % bundles[j].corners]] = 1;
      }
    }
  }
  return external;
}

}  // namespace coif
