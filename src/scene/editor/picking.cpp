#include "coif/scene/picking.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "scene/editor/adjacency.h"

namespace coif {
namespace {

double distanceToSegment(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 d = b - a;
  const double t = d.squaredNorm() > 0 ? std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0.0;
  return (p - a - t * d).norm();
}

/// Keeps the nearest so far; of those within a pixel of each other the one in front.
template <class T>
struct Nearest {
  std::optional<T> best;
  double distance = 0, depth = 0;
  void offer(const T& item, double itemDistance, double itemDepth) {
    const bool nearer = itemDistance < distance - 1, alike = itemDistance < distance + 1;
    if (!best || nearer || (alike && itemDepth < depth)) {
      best = item, distance = itemDistance, depth = itemDepth;
    }
  }
};

}  // namespace

bool insidePolygon(const Vec2& px, std::span<const Vec2> polygon) {
  bool in = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Vec2 &a = polygon[i], &b = polygon[j];
    if ((a.y() > px.y()) != (b.y() > px.y()) &&
        px.x() < (b.x() - a.x()) * (px.y() - a.y()) / (b.y() - a.y()) + a.x()) {
      in = !in;
    }
  }
  return in;
}

PickParts pickParts(const HairMesh& mesh, std::span<const BundleId> hidden, bool internal) {
  PickParts parts;
  const auto external = externalVertices(mesh);
  parts.shown.assign(mesh.vertices().size(), 0);
  using Quad = std::array<std::uint32_t, 4>;
  std::vector<std::pair<Quad, HullFace>> sides;  // by their corners in order, to find pairs
  for (const Bundle& bundle : mesh.bundles()) {
    if (std::ranges::binary_search(hidden, bundle.id)) continue;
    const std::uint32_t height = bundle.height();
    for (std::uint32_t layer = 0; layer <= height; ++layer) {
      const auto face = bundle.face(layer);
      for (std::uint32_t v : face) parts.shown[v] = internal || external[v];
      if (internal || layer == height) parts.faces.push_back({bundle.id, layer});
      for (std::uint32_t i = 0; layer > 0 && i < bundle.corners; ++i) {
        const auto low = bundle.face(layer - 1);
        const std::uint32_t next = (i + 1) % bundle.corners;
        const Quad corners{low[i], low[next], face[next], face[i]};
        Quad sorted = corners;
        std::ranges::sort(sorted);
        sides.push_back({sorted, {{bundle.id, layer}, corners, true}});
      }
    }
    parts.hull.push_back({{bundle.id, height}, {}, false});
  }
  std::ranges::stable_sort(sides, {}, [](const auto& side) { return side.first; });
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const bool shared = (i > 0 && sides[i - 1].first == sides[i].first) ||
                        (i + 1 < sides.size() && sides[i + 1].first == sides[i].first);
    if (!shared) parts.hull.push_back(sides[i].second);
  }
  const editor::Adjacency adjacency(mesh);
  for (const EdgeRef& edge : adjacency.edges()) {
    const auto [a, b] = adjacency.ends(edge);
    if (!parts.shown[a] || !parts.shown[b]) continue;
    parts.edges.push_back(edge);
    parts.edgeEnds.push_back({a, b});
  }
  return parts;
}

ScreenMesh::ScreenMesh(const HairMesh& mesh, const Camera& camera, int width, int height,
                       const PickOptions& options)
    : ScreenMesh(mesh, std::make_shared<PickParts>(pickParts(mesh, options.hidden, options.internal)), camera,
                 width, height, options.occluder) {}

ScreenMesh::ScreenMesh(const HairMesh& mesh, std::shared_ptr<const PickParts> parts, const Camera& camera,
                       int width, int height, const Surface* occluder, const ScreenMesh* before,
                       bool asBefore)
    : mesh_(mesh), camera_(camera), width_(width), height_(height), parts_(std::move(parts)) {
  forward_ = (camera.target - camera.eye).normalized();
  right_ = forward_.cross(camera.up).normalized();
  up_ = right_.cross(forward_);
  scale_ = 0.5 * height / std::tan(0.5 * camera.fovDeg * std::numbers::pi / 180);
  const std::size_t count = mesh.vertices().size();
  pickable_ = parts_->shown;
  seen_.assign(count, 1);
  points_.reserve(count), positions_.reserve(count);
  for (std::uint32_t v = 0; v < count; ++v) {
    const Vec3& at = mesh.position(v);
    positions_.push_back(at);
    points_.push_back(project(at));
    if (points_[v].depth <= 0) pickable_[v] = 0;
    if (!pickable_[v] || occluder == nullptr) continue;
    if (before != nullptr && (asBefore || before->positions_[v] == at)) {
      seen_[v] = before->seen_[v];
    } else {
      // Short of the vertex by a thousandth, so that roots on the head's own surface stay.
      SurfacePoint hit;
      seen_[v] = !occluder->intersect(camera.eye, at - camera.eye, 0.999, hit);
    }
    if (!seen_[v]) pickable_[v] = 0;
  }
}

ScreenPoint ScreenMesh::project(const Vec3& world) const {
  const Vec3 d = world - camera_.eye;
  const double depth = d.dot(forward_), scale = scale_ / std::max(depth, 1e-300);
  return {Vec2(0.5 * width_ + scale * d.dot(right_), 0.5 * height_ - scale * d.dot(up_)), depth};
}

std::optional<VertexId> ScreenMesh::vertexAt(const Vec2& px, double radiusPx) const {
  Nearest<VertexId> nearest;
  for (std::uint32_t v = 0; v < points_.size(); ++v) {
    const double distance = (points_[v].px - px).norm();
    if (pickable_[v] && distance <= radiusPx)
      nearest.offer(mesh_.vertices()[v].id, distance, points_[v].depth);
  }
  return nearest.best;
}

std::optional<EdgeRef> ScreenMesh::edgeAt(const Vec2& px, double radiusPx) const {
  Nearest<EdgeRef> nearest;
  for (std::size_t i = 0; i < parts_->edges.size(); ++i) {
    const auto [v, w] = parts_->edgeEnds[i];
    if (!pickable_[v] || !pickable_[w]) continue;
    const ScreenPoint &a = points_[v], &b = points_[w];
    const double distance = distanceToSegment(px, a.px, b.px);
    if (distance <= radiusPx) nearest.offer(parts_->edges[i], distance, std::min(a.depth, b.depth));
  }
  return nearest.best;
}

std::span<const std::uint32_t> ScreenMesh::cornersOf(const HullFace& face) const {
  if (face.side) return face.corners;
  return mesh_.bundles()[mesh_.indexOf(face.face.bundle)].face(face.face.layer);
}

std::optional<FaceRef> ScreenMesh::faceAt(const Vec2& px, bool hull) const {
  if (hull) {
    const auto found = hullFaceAt(px);
    return found ? std::optional(found->face) : std::nullopt;
  }
  std::optional<FaceRef> best;
  double nearest = 0;
  for (const FaceRef& face : parts_->faces) {
    std::vector<Vec2> outline;
    double depth = 0;
    bool seen = true;
    for (std::uint32_t v : mesh_.bundles()[mesh_.indexOf(face.bundle)].face(face.layer)) {
      outline.push_back(points_[v].px);
      depth += points_[v].depth;
      seen = seen && pickable_[v];
    }
    depth /= double(outline.size());
    if (!seen || !insidePolygon(px, outline) || (best && depth >= nearest)) continue;
    best = face, nearest = depth;
  }
  return best;
}

std::optional<HullFace> ScreenMesh::hullFaceAt(const Vec2& px) const {
  std::optional<HullFace> best;
  double nearest = 0;
  std::vector<Vec2> outline;
  for (const HullFace& face : parts_->hull) {
    outline.clear();
    double depth = 0;
    bool seen = false;  // in part is enough: the head cuts through the faces at the scalp
    for (std::uint32_t v : cornersOf(face)) {
      outline.push_back(points_[v].px);
      depth += points_[v].depth;
      seen = seen || pickable_[v];
    }
    depth /= double(outline.size());
    if (!seen || !insidePolygon(px, outline) || (best && depth >= nearest)) continue;
    best = face, nearest = depth;
  }
  return best;
}

std::optional<Vec3> ScreenMesh::hullAt(const Vec2& px) const {
  const auto face = hullFaceAt(px);
  if (!face) return std::nullopt;
  const auto corners = cornersOf(*face);
  Vec3 middle = Vec3::Zero(), normal = Vec3::Zero();
  for (std::uint32_t v : corners) middle += positions_[v] / double(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    normal += (positions_[corners[i]] - middle).cross(positions_[corners[(i + 1) % corners.size()]] - middle);
  }
  const Vec3 ray = forward_ + ((px.x() - 0.5 * width_) * right_ + (0.5 * height_ - px.y()) * up_) / scale_;
  const double along = ray.dot(normal);
  // On the face's mean plane, but no nearer or farther than its corners: one seen from the edge has no plane.
  double least = 1e300, most = -1e300;
  for (std::uint32_t v : corners) {
    least = std::min(least, points_[v].depth), most = std::max(most, points_[v].depth);
  }
  double depth = 0.5 * (least + most);
  if (along != 0) depth = std::clamp((middle - camera_.eye).dot(normal) / along, least, most);
  return camera_.eye + depth * ray;
}

std::optional<Vec3> ScreenMesh::nearestSeen(const Vec2& px) const {
  return vertexBeside(px, 1e300, {});
}

std::optional<Vec3> ScreenMesh::vertexBeside(const Vec2& px, double radiusPx,
                                             std::span<const VertexId> except) const {
  std::optional<Vec3> best;
  double nearest = radiusPx;
  for (std::uint32_t v = 0; v < points_.size(); ++v) {
    const double distance = (points_[v].px - px).norm();
    if (!pickable_[v] || distance > nearest) continue;
    if (std::ranges::binary_search(except, mesh_.vertices()[v].id)) continue;
    best = positions_[v], nearest = distance;
  }
  return best;
}

template <class Test>
Selection ScreenMesh::pickWhere(SelectKind kind, const Test& test) const {
  Selection out;
  if (kind == SelectKind::Vertex) {
    for (std::uint32_t v = 0; v < points_.size(); ++v) {
      if (pickable_[v] && test(points_[v].px)) out.vertices.push_back(mesh_.vertices()[v].id);
    }
  } else if (kind == SelectKind::Edge) {
    for (std::size_t i = 0; i < parts_->edges.size(); ++i) {
      const auto [a, b] = parts_->edgeEnds[i];
      if (pickable_[a] && pickable_[b] && test(points_[a].px) && test(points_[b].px))
        out.edges.push_back(parts_->edges[i]);
    }
  } else {
    const auto holds = [&](std::span<const std::uint32_t> corners) {
      Vec2 middle = Vec2::Zero();
      bool seen = true;
      for (std::uint32_t v : corners)
        middle += points_[v].px / double(corners.size()), seen = seen && pickable_[v];
      return seen && test(middle);
    };
    for (const FaceRef& face : parts_->faces) {
      if (kind == SelectKind::Face && holds(cornersOf({face, {}, false}))) out.faces.push_back(face);
    }
    for (const HullFace& face : parts_->hull) {
      if (kind != SelectKind::Face && holds(cornersOf(face))) out.faces.push_back(face.face);
    }
    std::ranges::sort(out.faces);
    out.faces.erase(std::unique(out.faces.begin(), out.faces.end()), out.faces.end());
  }
  return out;
}

Selection ScreenMesh::inside(std::span<const Vec2> polygon, SelectKind kind) const {
  return pickWhere(kind, [&](const Vec2& px) { return insidePolygon(px, polygon); });
}

Selection ScreenMesh::near(const Vec2& px, double radiusPx, SelectKind kind) const {
  return pickWhere(kind, [&](const Vec2& at) { return (at - px).norm() <= radiusPx; });
}

}  // namespace coif
