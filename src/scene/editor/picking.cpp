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

ScreenMesh::ScreenMesh(const HairMesh& mesh, const Camera& camera, int width, int height,
                       const PickOptions& options)
    : mesh_(mesh), camera_(camera), width_(width), height_(height) {
  forward_ = (camera.target - camera.eye).normalized();
  right_ = forward_.cross(camera.up).normalized();
  up_ = right_.cross(forward_);
  scale_ = 0.5 * height / std::tan(0.5 * camera.fovDeg * std::numbers::pi / 180);

  const auto external = externalVertices(mesh);
  pickable_.assign(mesh.vertices().size(), 0);
  const editor::Adjacency adjacency(mesh);
  for (const Bundle& bundle : mesh.bundles()) {
    if (std::ranges::binary_search(options.hidden, bundle.id)) continue;
    for (std::uint32_t layer = 0; layer <= bundle.height(); ++layer) {
      for (std::uint32_t v : bundle.face(layer)) pickable_[v] = options.internal || external[v];
      if (options.internal || layer == bundle.height()) faces_.push_back({bundle.id, layer});
    }
  }
  points_.reserve(pickable_.size());
  for (std::uint32_t v = 0; v < pickable_.size(); ++v) {
    const Vec3& at = mesh.position(v);
    points_.push_back(project(at));
    if (!pickable_[v]) continue;
    if (points_[v].depth <= 0) pickable_[v] = 0;
    if (pickable_[v] && options.occluder != nullptr) {
      // Short of the vertex by a thousandth, so that roots on the head's own surface stay.
      SurfacePoint hit;
      if (options.occluder->intersect(camera.eye, at - camera.eye, 0.999, hit)) pickable_[v] = 0;
    }
  }
  for (const EdgeRef& edge : adjacency.edges()) {
    const auto [a, b] = adjacency.ends(edge);
    if (pickable_[a] && pickable_[b]) edges_.push_back(edge);
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
  for (const EdgeRef& edge : edges_) {
    const auto corners = selectedVertices(mesh_, {{}, {edge}, {}});
    const ScreenPoint &a = points_[corners[0]], &b = points_[corners[1]];
    const double distance = distanceToSegment(px, a.px, b.px);
    if (distance <= radiusPx) nearest.offer(edge, distance, std::min(a.depth, b.depth));
  }
  return nearest.best;
}

std::optional<FaceRef> ScreenMesh::faceAt(const Vec2& px) const {
  std::optional<FaceRef> best;
  double nearest = 0;
  for (const FaceRef& face : faces_) {
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

template <class Test>
Selection ScreenMesh::pickWhere(SelectKind kind, const Test& test) const {
  Selection out;
  if (kind == SelectKind::Vertex) {
    for (std::uint32_t v = 0; v < points_.size(); ++v) {
      if (pickable_[v] && test(points_[v].px)) out.vertices.push_back(mesh_.vertices()[v].id);
    }
  } else if (kind == SelectKind::Edge) {
    std::ranges::copy_if(edges_, std::back_inserter(out.edges), [&](const EdgeRef& edge) {
      const auto corners = selectedVertices(mesh_, {{}, {edge}, {}});
      return test(points_[corners[0]].px) && test(points_[corners[1]].px);
    });
  } else {
    std::ranges::copy_if(faces_, std::back_inserter(out.faces), [&](const FaceRef& face) {
      Vec2 middle = Vec2::Zero();
      bool seen = true;
      const auto corners = mesh_.bundles()[mesh_.indexOf(face.bundle)].face(face.layer);
      for (std::uint32_t v : corners)
        middle += points_[v].px / double(corners.size()), seen = seen && pickable_[v];
      return seen && test(middle);
    });
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
