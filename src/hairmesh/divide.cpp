// Edge divide, face divide and their inverses.
#include "hairmesh/divide.h"

#include <algorithm>

#include "coif/hairmesh/operations.h"
#include "hairmesh/select.h"

namespace coif {
namespace hairmesh {
namespace {

/// The vertices inserted on each side, by layer; empty for sides that stay whole.
using Columns = std::vector<std::vector<std::uint32_t>>;

std::vector<EdgeSplit> dividedSplits(const HairMeshBuilder& b, const Columns& columns) {
  std::vector<EdgeSplit> result;
  for (const EdgeSplit& split : b.splits()) {
    const std::uint32_t side = b.topology.findEdge(b.bundles, split.a, split.b);
    if (columns[side].empty()) {
      result.push_back(split);
      continue;
    }
    const std::uint32_t middle = columns[side][0];  // the newest vertices have the highest indices
    result.push_back({split.a, middle, split.layer});
    result.push_back({split.b, middle, split.layer});
  }
  return result;
}

void insertColumns(Bundle& bundle, std::span<const std::vector<std::uint32_t>> columns) {
  const std::uint32_t layers = layerCountOf(bundle);
  std::vector<std::uint32_t> rows;
  for (std::uint32_t k = 0; k < layers; ++k) {
    const auto face = bundle.face(k);
    for (std::uint32_t i = 0; i < bundle.corners; ++i) {
      rows.push_back(face[i]);
      if (!columns[i].empty()) rows.push_back(columns[i][k]);
    }
  }
  bundle.corners = std::uint32_t(rows.size() / layers);
  bundle.vertices = std::move(rows);
}

}  // namespace

Status divideSides(HairMeshBuilder& b, std::span<const std::uint32_t> sides,
                   const std::function<Vec3(std::uint32_t, std::uint32_t)>& position) {
  Columns columns(b.topology.sideCount());
  const auto grow = [&](std::uint32_t side, std::uint32_t k) {
    const std::uint32_t parent = k == 0 ? kNone : columns[side][k - 1];
    const bool pinned = b.vertices[b.at(side, k)].pinned && b.vertices[b.at(b.topology.next(side), k)].pinned;
    columns[side].push_back(b.addVertex(position(side, k), parent, k, pinned));
  };
  for (const std::uint32_t side : sides) {
    for (std::uint32_t k = 0; k < b.layers(b.topology.bundleOf(side)); ++k) grow(side, k);
    const std::uint32_t other = b.topology.opposite(side);
    if (other == kNone) continue;
    for (std::uint32_t k = 0; k < b.layers(b.topology.bundleOf(other)); ++k) {
      if (b.joined(side, k)) {
        columns[other].push_back(columns[side][k]);
      } else {
        grow(other, k);
      }
    }
  }
  const auto splits = dividedSplits(b, columns);
  for (std::uint32_t j = 0; j < b.bundles.size(); ++j) {
    const auto own = std::span(columns).subspan(b.topology.side(j, 0), b.bundles[j].corners);
    if (std::any_of(own.begin(), own.end(), [](const auto& column) { return !column.empty(); })) {
      insertColumns(b.bundles[j], own);
    }
  }
  return b.retopologise(splits);
}

namespace {

Status divideAt(HairMeshBuilder& b, std::uint32_t side, double t) {
  const std::uint32_t sides[] = {side};
  return divideSides(b, sides, [&](std::uint32_t of, std::uint32_t k) -> Vec3 {
    // Both sides of a separated edge in the same direction, so that coincident sides get coincident points.
    std::uint32_t from = b.at(of, k), to = b.at(b.topology.next(of), k);
    if (of != side) std::swap(from, to);
    const Vec3 &p = b.vertices[from].position, &q = b.vertices[to].position;
    return p + t * (q - p);
  });
}

Status checkPoint(const Bundle& bundle, const FacePoint& point) {
  if (point.corner >= bundle.corners) return refuse("the face has no such corner", placeOf(bundle.id));
  if (!(point.t >= 0 && point.t < 1)) {
    return refuse("t must be 0 for a corner, or between 0 and 1 on a side", placeOf(bundle.id));
  }
  return {};
}

/// Takes corners out of every layer of a bundle: keep(i) says which stay.
template <class Keep>
std::vector<std::uint32_t> pickCorners(const Bundle& bundle, Keep keep) {
  std::vector<std::uint32_t> rows;
  for (std::size_t c = 0; c < bundle.vertices.size(); ++c) {
    if (keep(std::uint32_t(c % bundle.corners))) rows.push_back(bundle.vertices[c]);
  }
  return rows;
}

}  // namespace
}  // namespace hairmesh

using namespace hairmesh;

Result<Created> divideEdge(HairMesh& mesh, EdgeRef edge, double t) {
  COIF_ASSIGN(const std::uint32_t j, selectEdge(mesh, edge));
  if (!(t > 0 && t < 1)) return refuse("t must lie between 0 and 1", placeOf(edge));
  COIF_ASSIGN(HairMeshBuilder b, HairMeshBuilder::from(mesh));
  COIF_TRY(divideAt(b, b.topology.side(j, edge.side), t));
  return commitCreated(b, mesh);
}

Result<Created> divideFace(HairMesh& mesh, BundleId id, FacePoint from, FacePoint to) {
  COIF_ASSIGN(const std::uint32_t j, selectFace(mesh, {id, 0}));
  COIF_TRY(checkPoint(mesh.bundles()[j], from));
  COIF_TRY(checkPoint(mesh.bundles()[j], to));
  if (from.corner == to.corner) return refuse("the two points are the same or lie on one side", placeOf(id));
  if (from.corner > to.corner) std::swap(from, to);
  COIF_ASSIGN(HairMeshBuilder b, HairMeshBuilder::from(mesh));
  // The later side first: it does not move the corners of the earlier one.
  std::uint32_t low = from.corner, high = to.corner;
  if (to.t > 0) {
    COIF_TRY(divideAt(b, b.topology.side(j, to.corner), to.t));
    ++high;
  }
  if (from.t > 0) {
    COIF_TRY(divideAt(b, b.topology.side(j, from.corner), from.t));
    ++low, ++high;
  }
  const std::uint32_t n = b.bundles[j].corners;
  if (high == low + 1 || (low == 0 && high == n - 1))
    return refuse("the two points are neighbours", placeOf(id));
  if (b.topology.findEdge(b.bundles, b.at(j, 0, low), b.at(j, 0, high)) != kNone) {
    return refuse("another root edge joins these corners already", placeOf(id));
  }
  const auto splits = b.splits();
  auto rows = pickCorners(b.bundles[j], [&](std::uint32_t i) { return i >= low && i <= high; });
  const std::uint32_t fresh = b.addBundle(high - low + 1, b.bundles[j].group, std::move(rows));
  b.bundles[j].vertices = pickCorners(b.bundles[j], [&](std::uint32_t i) { return i <= low || i >= high; });
  b.bundles[j].corners = n - (high - low - 1);
  Created created{{}, {id, b.bundles[fresh].id}, {}};
  COIF_TRY(b.retopologise(splits));
  return commitCreated(b, mesh, std::move(created));
}

Result<Created> dissolveEdge(HairMesh& mesh, EdgeRef edge) {
  COIF_ASSIGN(const std::uint32_t j, selectEdge(mesh, edge));
  COIF_ASSIGN(HairMeshBuilder b, HairMeshBuilder::from(mesh));
  std::uint32_t side = b.topology.side(j, edge.side), other = b.topology.opposite(side);
  if (other == kNone) return refuse("the edge has one bundle only", placeOf(edge));
  if (other < side) std::swap(side, other);
  Bundle &kept = b.bundles[b.topology.bundleOf(side)], &gone = b.bundles[b.topology.bundleOf(other)];
  if (kept.height() != gone.height()) return refuse("the two bundles have different heights", placeOf(edge));
  if (b.topology.split(side) != kNone)
    return refuse("the edge is separated on a higher layer", placeOf(edge));
  const std::uint32_t at = b.topology.cornerOf(side), from = b.topology.cornerOf(other) + 2;
  std::vector<std::uint32_t> rows;
  for (std::uint32_t k = 0; k <= kept.height(); ++k) {
    const auto mine = kept.face(k), theirs = gone.face(k);
    rows.insert(rows.end(), mine.begin(), mine.begin() + at + 1);
    for (std::uint32_t i = 0; i + 2 < gone.corners; ++i) rows.push_back(theirs[(from + i) % gone.corners]);
    rows.insert(rows.end(), mine.begin() + at + 1, mine.end());
  }
  const std::uint32_t corners = kept.corners + gone.corners - 2;
  std::vector<std::uint32_t> outline(rows.begin(), rows.begin() + corners);
  std::sort(outline.begin(), outline.end());
  if (std::adjacent_find(outline.begin(), outline.end()) != outline.end()) {
    return refuse("the two bundles share more than this edge", placeOf(edge));
  }
  const auto splits = b.splits();
  const Created created{{}, {kept.id}, {}};
  kept.corners = corners;
  kept.vertices = std::move(rows);
  gone.vertices.clear();
  COIF_TRY(b.retopologise(splits));
  return commitCreated(b, mesh, created);
}

Result<Created> dissolveVertex(HairMesh& mesh, VertexId id) {
  const std::uint32_t v = mesh.indexOf(id);
  if (v == kNone) return makeError(ErrorCode::NotFound, "the mesh has no such vertex", placeOf(id));
  if (mesh.vertices()[v].layer != 0) return refuse("the vertex is not on the root layer", placeOf(id));
  COIF_ASSIGN(HairMeshBuilder b, HairMeshBuilder::from(mesh));
  const auto corners = b.topology.around(v);
  const std::uint32_t c = corners[0];
  const std::uint32_t before = b.at(b.topology.prev(c), 0), after = b.at(b.topology.next(c), 0);
  const bool inside = corners.size() == 2 && b.at(b.topology.prev(corners[1]), 0) == after &&
                      b.at(b.topology.next(corners[1]), 0) == before;
  if (corners.size() != 1 && !inside) return refuse("the vertex has more than two root edges", placeOf(id));
  if (b.topology.split(c) != b.topology.split(b.topology.prev(c))) {
    return refuse("the two edges of the vertex are separated on different layers", placeOf(id));
  }
  for (const std::uint32_t corner : corners) {
    if (b.bundles[b.topology.bundleOf(corner)].corners < 4) {
      return refuse("a triangle would lose its third corner", placeOf(id));
    }
  }
  if (b.topology.findEdge(b.bundles, before, after) != kNone) {
    return refuse("another root edge joins the neighbours of the vertex", placeOf(id));
  }
  auto splits = b.splits();
  std::erase_if(splits, [&](const EdgeSplit& split) { return split.a == v || split.b == v; });
  if (b.topology.split(c) != kNone) {
    splits.push_back({std::min(before, after), std::max(before, after), b.topology.split(c)});
  }
  for (const std::uint32_t corner : corners) {
    Bundle& bundle = b.bundles[b.topology.bundleOf(corner)];
    const std::uint32_t out = b.topology.cornerOf(corner);
    bundle.vertices = pickCorners(bundle, [&](std::uint32_t i) { return i != out; });
    --bundle.corners;
  }
  COIF_TRY(b.retopologise(splits));
  return commitCreated(b, mesh);
}

}  // namespace coif
