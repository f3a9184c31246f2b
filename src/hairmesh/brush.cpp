#include "coif/hairmesh/brush.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "hairmesh/hull.h"
#include "hairmesh/select.h"

namespace coif {
namespace {

using namespace hairmesh;

constexpr double kSpacing = 0.25;   // of the radius, from dab to dab
constexpr double kDabHeight = 0.1;  // of the radius: how far a dab of strength 1 pushes

Status check(const HairMesh& mesh, const BrushStroke& stroke, const VertexWeights& mask) {
  if (stroke.path.empty()) return refuse("the stroke has no point", "path");
  for (const Vec3& p : stroke.path) {
    if (!p.allFinite()) return refuse("a point of the stroke is not finite", "path");
  }
  if (!(stroke.radius > 0) || !std::isfinite(stroke.radius))
    return refuse("the radius is not positive", "radius");
  const double least = stroke.kind == BrushKind::Smooth ? 0 : -1;
  if (!(stroke.strength >= least && stroke.strength <= 1))
    return refuse(least < 0 ? "the strength is not between -1 and 1" : "the strength is not between 0 and 1",
                  "strength");
  if (!stroke.through.allFinite()) return refuse("the direction is not finite", "through");
  if (!mask.empty() && mask.size() != mesh.vertices().size())
    return refuse("there must be one weight a vertex", "mask");
  return {};
}

/// The line's points a quarter radius apart, and its end.
std::vector<Vec3> dabsOf(const BrushStroke& stroke) {
  const double step = kSpacing * stroke.radius;
  std::vector<Vec3> dabs{stroke.path.front()};
  double toGo = step;
  for (std::size_t i = 1; i < stroke.path.size(); ++i) {
    Vec3 at = stroke.path[i - 1];
    double left = (stroke.path[i] - at).norm();
    while (left >= toGo && left > 0) {
      at += toGo / left * (stroke.path[i] - at);
      left -= toGo;
      toGo = step;
      dabs.push_back(at);
    }
    toGo -= left;
  }
  if (stroke.path.size() > 1 && toGo < step) dabs.push_back(stroke.path.back());
  return dabs;
}

class Stroke {
 public:
  Stroke(HairMesh& mesh, const BrushStroke& stroke, const VertexWeights& mask)
      : mesh_(mesh), stroke_(stroke), mask_(mask) {
    const Vec3 axis = stroke.through;
    axis_ = axis.isZero(0) ? Vec3(Vec3::Zero()) : Vec3(axis.normalized());
    quads_ = sideQuads(mesh);
    order_.resize(mesh.vertices().size());
    std::iota(order_.begin(), order_.end(), 0u);
    std::ranges::stable_sort(order_, {}, [&](std::uint32_t v) { return mesh.vertices()[v].layer; });
    for (const HairVertex& vertex : mesh.vertices()) {
      lengths_.push_back(vertex.parent == kNone ? 0
                                                : (vertex.position - mesh.position(vertex.parent)).norm());
    }
  }

  Status run() {
    const std::vector<Vec3> dabs = dabsOf(stroke_);
    if (stroke_.kind == BrushKind::Grab) {
      move(weightsAt(dabs.front()), stroke_.strength * (stroke_.path.back() - stroke_.path.front()));
      return {};
    }
    for (std::size_t i = 0; i < dabs.size(); ++i) {
      const Vec3 by = i + 1 < dabs.size() ? Vec3(dabs[i + 1] - dabs[i]) : Vec3(Vec3::Zero());
      COIF_TRY(dab(dabs[i], by));
    }
    return {};
  }

 private:
  double maskOf(std::uint32_t v) const {
    if (mesh_.vertices()[v].layer == 0 && !stroke_.roots) return 0;
    return mask_.empty() ? 1 : mask_[v];
  }

  VertexWeights weightsAt(const Vec3& centre) const {
    VertexWeights weights(order_.size());
    for (std::uint32_t v = 0; v < weights.size(); ++v) {
      const Vec3 d = mesh_.position(v) - centre;
      weights[v] = maskOf(v) * falloffAt(stroke_.falloff, (d - d.dot(axis_) * axis_).norm() / stroke_.radius);
    }
    return weights;
  }

  void move(const VertexWeights& weights, const Vec3& by) {
    for (std::uint32_t v = 0; v < weights.size(); ++v) {
      if (weights[v] > 0) mesh_.setPosition(v, mesh_.position(v) + weights[v] * by);
    }
  }

  /// Root to tip: every vertex back to its distance from its parent, in the direction that it now has.
  void keepLengths() {
    for (std::uint32_t v : order_) {
      const std::uint32_t parent = mesh_.vertices()[v].parent;
      if (parent == kNone || maskOf(v) <= 0) continue;
      const Vec3 link = mesh_.position(v) - mesh_.position(parent);
      const double length = link.norm();
      // What has its length to rounding is left bit for bit.
      if (length > 0 && std::abs(length - lengths_[v]) > 1e-12 * lengths_[v])
        mesh_.setPosition(v, mesh_.position(parent) + lengths_[v] / length * link);
    }
  }

  Status dab(const Vec3& centre, const Vec3& by) {
    const VertexWeights weights = weightsAt(centre);
    if (std::ranges::none_of(weights, [](double w) { return w > 0; })) return {};
    switch (stroke_.kind) {
      case BrushKind::Comb:
        move(weights, stroke_.strength * by);
        keepLengths();
        return {};
      case BrushKind::Push:
      case BrushKind::Pull:
        move(weights, (stroke_.kind == BrushKind::Push ? -height() : height()) * meanNormal(weights));
        return {};
      case BrushKind::Inflate: {
        const std::vector<Vec3> normals = hairmesh::hullNormals(mesh_, quads_);
        for (std::uint32_t v = 0; v < weights.size(); ++v) {
          mesh_.setPosition(v, mesh_.position(v) + weights[v] * height() * normals[v]);
        }
        return {};
      }
      case BrushKind::Twist:
        return twist(weights, by);
      case BrushKind::Smooth:
        return smooth(mesh_, weights, stroke_.strength);
      case BrushKind::Grab:
        break;
    }
    return {};
  }

  double height() const { return kDabHeight * stroke_.strength * stroke_.radius; }

  Vec3 meanNormal(const VertexWeights& weights) const {
    const std::vector<Vec3> normals = hairmesh::hullNormals(mesh_, quads_);
    Vec3 sum = Vec3::Zero();
    for (std::uint32_t v = 0; v < weights.size(); ++v) sum += weights[v] * normals[v];
    return sum.norm() > 1e-12 ? Vec3(sum.normalized()) : Vec3(Vec3::Zero());
  }

  Status twist(const VertexWeights& weights, const Vec3& by) {
    Vec3 along = Vec3::Zero(), middle = Vec3::Zero();
    double sum = 0;
    for (std::uint32_t v = 0; v < weights.size(); ++v) {
      const std::uint32_t parent = mesh_.vertices()[v].parent;
      if (parent == kNone || weights[v] <= 0) continue;
      along += weights[v] * (mesh_.position(v) - mesh_.position(parent));
      middle += weights[v] * mesh_.position(v);
      sum += weights[v];
    }
    if (!(along.norm() > 1e-12) || by.isZero(0)) return {};
    along.normalize();
    const double angle = stroke_.strength * along.dot(meanNormal(weights).cross(by)) / stroke_.radius;
    return rotate(mesh_, weights, middle / sum, along, angle);
  }

  HairMesh& mesh_;
  const BrushStroke& stroke_;
  const VertexWeights& mask_;
  Vec3 axis_;
  std::vector<std::uint32_t> order_;  // parents first
  std::vector<SideQuad> quads_;
  std::vector<double> lengths_;  // to the parent, before the stroke
};

}  // namespace

Status brush(HairMesh& mesh, const BrushStroke& stroke, const VertexWeights& mask) {
  COIF_TRY(check(mesh, stroke, mask));
  HairMesh brushed = mesh;
  COIF_TRY(Stroke(brushed, stroke, mask).run());
  for (std::uint32_t v = 0; v < brushed.vertices().size(); ++v) {
    if (!brushed.position(v).allFinite())
      return refuse("the stroke leaves a position not finite", placeOf(brushed.vertices()[v].id));
  }
  mesh = std::move(brushed);
  return {};
}

}  // namespace coif
