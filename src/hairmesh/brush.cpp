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

Status checkPath(std::span<const Vec3> path) {
  for (const Vec3& p : path) {
    if (!p.allFinite()) return refuse("a point of the stroke is not finite", "path");
  }
  return {};
}

Status check(const HairMesh& mesh, const BrushStroke& stroke, const VertexWeights& mask) {
  if (stroke.path.empty()) return refuse("the stroke has no point", "path");
  COIF_TRY(checkPath(stroke.path));
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

}  // namespace

/// Dabs stand a quarter radius apart along the path. One is done when the next is known, since it moves hair
/// towards that; the last, and what the path has beyond it, are done anew on a copy each time.
struct GrowingStroke::Impl {
 public:
  Impl(const HairMesh& mesh, BrushStroke stroke, VertexWeights mask)
      : mesh_(mesh), stroke_(std::move(stroke)), mask_(std::move(mask)) {
    const Vec3 axis = stroke_.through;
    axis_ = axis.isZero(0) ? Vec3(Vec3::Zero()) : Vec3(axis.normalized());
    quads_ = sideQuads(mesh);
    order_.resize(mesh.vertices().size());
    std::iota(order_.begin(), order_.end(), 0u);
    std::ranges::stable_sort(order_, {}, [&](std::uint32_t v) { return mesh.vertices()[v].layer; });
    for (const HairVertex& vertex : mesh.vertices()) {
      lengths_.push_back(vertex.parent == kNone ? 0
                                                : (vertex.position - mesh.position(vertex.parent)).norm());
    }
    last_ = stroke_.path.front();
    toGo_ = step();
  }

  const BrushStroke& stroke() const { return stroke_; }
  const VertexWeights& mask() const { return mask_; }

  /// Does the dabs of the path's points from `first` on.
  Status goOn(std::size_t first) {
    for (std::size_t i = std::max<std::size_t>(first, 1); i < stroke_.path.size(); ++i) {
      Vec3 at = stroke_.path[i - 1];
      double left = (stroke_.path[i] - at).norm();
      while (left >= toGo_ && left > 0) {
        at += toGo_ / left * (stroke_.path[i] - at);
        left -= toGo_;
        toGo_ = step();
        COIF_TRY(dab(mesh_, last_, at - last_));
        last_ = at;
      }
      toGo_ -= left;
    }
    return {};
  }

  void append(std::span<const Vec3> points) {
    stroke_.path.insert(stroke_.path.end(), points.begin(), points.end());
  }

  Result<HairMesh> ended() const {
    HairMesh mesh = mesh_;
    const Vec3 &begin = stroke_.path.front(), &end = stroke_.path.back();
    if (stroke_.kind == BrushKind::Grab) {
      move(mesh, weightsAt(mesh, begin), stroke_.strength * (end - begin));
    } else if (stroke_.path.size() > 1 && toGo_ < step()) {
      COIF_TRY(dab(mesh, last_, end - last_));
      COIF_TRY(dab(mesh, end, Vec3::Zero()));
    } else {
      COIF_TRY(dab(mesh, last_, Vec3::Zero()));
    }
    for (const HairVertex& vertex : mesh.vertices()) {
      if (!vertex.position.allFinite())
        return refuse("the stroke leaves a position not finite", placeOf(vertex.id));
    }
    return mesh;
  }

 private:
  double step() const { return kSpacing * stroke_.radius; }

  double maskOf(std::uint32_t v) const {
    if (mesh_.vertices()[v].layer == 0 && !stroke_.roots) return 0;
    return mask_.empty() ? 1 : mask_[v];
  }

  VertexWeights weightsAt(const HairMesh& mesh, const Vec3& centre) const {
    VertexWeights weights(order_.size());
    for (std::uint32_t v = 0; v < weights.size(); ++v) {
      const Vec3 d = mesh.position(v) - centre;
      weights[v] = maskOf(v) * falloffAt(stroke_.falloff, (d - d.dot(axis_) * axis_).norm() / stroke_.radius);
    }
    return weights;
  }

  static void move(HairMesh& mesh, const VertexWeights& weights, const Vec3& by) {
    for (std::uint32_t v = 0; v < weights.size(); ++v) {
      if (weights[v] > 0) mesh.setPosition(v, mesh.position(v) + weights[v] * by);
    }
  }

  /// Root to tip: every vertex back to its distance from its parent, in the direction that it now has.
  void keepLengths(HairMesh& mesh) const {
    for (std::uint32_t v : order_) {
      const std::uint32_t parent = mesh.vertices()[v].parent;
      if (parent == kNone || maskOf(v) <= 0) continue;
      const Vec3 link = mesh.position(v) - mesh.position(parent);
      const double length = link.norm();
      // What has its length to rounding is left bit for bit.
      if (length > 0 && std::abs(length - lengths_[v]) > 1e-12 * lengths_[v])
        mesh.setPosition(v, mesh.position(parent) + lengths_[v] / length * link);
    }
  }

  Status dab(HairMesh& mesh, const Vec3& centre, const Vec3& by) const {
    if (stroke_.kind == BrushKind::Grab) return {};  // one move, from begin to end
    const VertexWeights weights = weightsAt(mesh, centre);
    if (std::ranges::none_of(weights, [](double w) { return w > 0; })) return {};
    switch (stroke_.kind) {
      case BrushKind::Comb:
        move(mesh, weights, stroke_.strength * by);
        keepLengths(mesh);
        return {};
      case BrushKind::Push:
      case BrushKind::Pull:
        move(mesh, weights,
             (stroke_.kind == BrushKind::Push ? -height() : height()) * meanNormal(mesh, weights));
        return {};
      case BrushKind::Inflate: {
        const std::vector<Vec3> normals = hairmesh::hullNormals(mesh, quads_);
        for (std::uint32_t v = 0; v < weights.size(); ++v) {
          mesh.setPosition(v, mesh.position(v) + weights[v] * height() * normals[v]);
        }
        return {};
      }
      case BrushKind::Twist:
        return twist(mesh, weights, by);
      case BrushKind::Smooth:
        return smooth(mesh, weights, stroke_.strength);
      case BrushKind::Grab:
        break;  // above
    }
    return {};
  }

  double height() const { return kDabHeight * stroke_.strength * stroke_.radius; }

  Vec3 meanNormal(const HairMesh& mesh, const VertexWeights& weights) const {
    const std::vector<Vec3> normals = hairmesh::hullNormals(mesh, quads_);
    Vec3 sum = Vec3::Zero();
    for (std::uint32_t v = 0; v < weights.size(); ++v) sum += weights[v] * normals[v];
    return sum.norm() > 1e-12 ? Vec3(sum.normalized()) : Vec3(Vec3::Zero());
  }

  Status twist(HairMesh& mesh, const VertexWeights& weights, const Vec3& by) const {
    Vec3 along = Vec3::Zero(), middle = Vec3::Zero();
    double sum = 0;
    for (std::uint32_t v = 0; v < weights.size(); ++v) {
      const std::uint32_t parent = mesh.vertices()[v].parent;
      if (parent == kNone || weights[v] <= 0) continue;
      along += weights[v] * (mesh.position(v) - mesh.position(parent));
      middle += weights[v] * mesh.position(v);
      sum += weights[v];
    }
    if (!(along.norm() > 1e-12) || by.isZero(0)) return {};
    along.normalize();
    const double angle = stroke_.strength * along.dot(meanNormal(mesh, weights).cross(by)) / stroke_.radius;
    return rotate(mesh, weights, middle / sum, along, angle);
  }

  HairMesh mesh_;  // after all dabs but the last
  BrushStroke stroke_;
  VertexWeights mask_;
  Vec3 axis_, last_;
  double toGo_ = 0;                   // from the path's end to the next dab
  std::vector<std::uint32_t> order_;  // parents first
  std::vector<SideQuad> quads_;
  std::vector<double> lengths_;  // to the parent, before the stroke
};

GrowingStroke::GrowingStroke(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
GrowingStroke::GrowingStroke(GrowingStroke&&) noexcept = default;
GrowingStroke& GrowingStroke::operator=(GrowingStroke&&) noexcept = default;
GrowingStroke::~GrowingStroke() = default;

Result<GrowingStroke> GrowingStroke::begin(const HairMesh& mesh, BrushStroke stroke, VertexWeights mask) {
  COIF_TRY(check(mesh, stroke, mask));
  GrowingStroke out(std::make_unique<Impl>(mesh, std::move(stroke), std::move(mask)));
  COIF_TRY(out.impl_->goOn(1));
  return out;
}

Status GrowingStroke::extend(std::span<const Vec3> points) {
  COIF_TRY(checkPath(points));
  const std::size_t before = stroke().path.size();
  impl_->append(points);
  return impl_->goOn(before);
}

const BrushStroke& GrowingStroke::stroke() const {
  return impl_->stroke();
}
const VertexWeights& GrowingStroke::mask() const {
  return impl_->mask();
}
Result<HairMesh> GrowingStroke::mesh() const {
  return impl_->ended();
}

Status brush(HairMesh& mesh, const BrushStroke& stroke, const VertexWeights& mask) {
  COIF_ASSIGN(const GrowingStroke grown, GrowingStroke::begin(mesh, stroke, mask));
  COIF_ASSIGN(mesh, grown.mesh());
  return {};
}

}  // namespace coif
