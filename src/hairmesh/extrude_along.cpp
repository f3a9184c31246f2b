// Several layers at once: straight, bending towards a direction, or along a curve.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "coif/hairmesh/operations.h"
#include "hairmesh/select.h"

namespace coif {
namespace {

using namespace hairmesh;

Status check(const ExtrudePath& path) {
  if (path.layers < 1) return refuse("there must be at least one layer", "layers");
  if (!(path.bend >= 0 && path.bend <= 1)) return refuse("the bend is not between 0 and 1", "bend");
  if (!std::isfinite(path.length) || !path.towards.allFinite())
    return refuse("the length or the direction is not finite", "path");
  for (const Vec3& p : path.curve) {
    if (!p.allFinite()) return refuse("a point of the curve is not finite", "curve");
  }
  return {};
}

/// A line of points by arc length.
class Curve {
 public:
  explicit Curve(const std::vector<Vec3>& points) {
    for (const Vec3& p : points) {
      const double step = points_.empty() ? 0 : (p - points_.back()).norm();
      if (!points_.empty() && !(step > 0)) continue;
      lengths_.push_back(points_.empty() ? 0 : lengths_.back() + step);
      points_.push_back(p);
    }
  }
  double length() const { return lengths_.empty() ? 0 : lengths_.back(); }
  Vec3 at(double s) const {
    const std::size_t i = segment(s);
    const double t = (s - lengths_[i]) / (lengths_[i + 1] - lengths_[i]);
    return points_[i] + t * (points_[i + 1] - points_[i]);
  }
  /// Rotation from its first direction to the one at s, by the smallest turn at each corner.
  Eigen::Quaterniond turnTo(double s) const {
    Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
    for (std::size_t i = 0; i < segment(s); ++i) {
      turn =
          Eigen::Quaterniond::FromTwoVectors(points_[i + 1] - points_[i], points_[i + 2] - points_[i + 1]) *
          turn;
    }
    return turn;
  }

 private:
  std::size_t segment(double s) const {
    const auto after = std::upper_bound(lengths_.begin() + 1, lengths_.end() - 1, s);
    return std::size_t(after - lengths_.begin()) - 1;
  }
  std::vector<Vec3> points_;
  std::vector<double> lengths_;
};

/// The corners of the bundles' tips and where each one's hair goes.
Result<std::map<std::uint32_t, Vec3>> tipDirections(const HairMesh& mesh, std::span<const BundleId> bundles) {
  HairMesh straight = mesh;
  ExtrudeOptions one;
  one.distance = 1;
  COIF_ASSIGN(const Created created, extrudeFaces(straight, bundles, one));
  std::map<std::uint32_t, Vec3> directions;
  for (VertexId id : created.vertices) {
    const HairVertex& vertex = straight.vertices()[straight.indexOf(id)];
    const HairVertex& tip = straight.vertices()[vertex.parent];
    const bool grown = tip.parent != kNone && tip.position != straight.position(tip.parent);
    directions[vertex.parent] = grown ? Vec3((tip.position - straight.position(tip.parent)).normalized())
                                      : Vec3(vertex.position - tip.position);
  }
  return directions;
}

Vec3 bent(const Vec3& direction, const ExtrudePath& path) {
  if (path.bend == 0 || path.towards.isZero(0)) return direction;
  const Vec3 turned = (1 - path.bend) * direction + path.bend * path.towards.normalized();
  return turned.norm() > 1e-12 ? Vec3(turned.normalized()) : direction;  // against each other: as it was
}

/// Where a curve carries points that lay about the tips' middle, on its own side or on the other.
class Carrier {
 public:
  Carrier(const HairMesh& mesh, std::span<const BundleId> bundles, const ExtrudePath& path)
      : path_(path), curve_(path.curve) {
    for (std::size_t i = 0; i < bundles.size(); ++i) {
      const Bundle& bundle = mesh.bundles()[mesh.indexOf(bundles[i])];
      for (std::uint32_t v : bundle.face(bundle.height()))
        side_[v] |= path.sides ? std::uint8_t(path.sides->of[i]) : std::uint8_t(CurveSides::Curve);
    }
    double count = 0;
    for (const auto& [v, side] : side_) {
      if (side & CurveSides::Curve) middle_ += mesh.position(v), ++count;
    }
    middle_ /= std::max(count, 1.0);
  }

  double length() const { return curve_.length(); }
  /// Of a tip's vertex that was `tip` before and started at `start`.
  Vec3 carried(std::uint32_t tip, const Vec3& start, double s) const {
    const std::uint8_t side = side_.at(tip);
    if (side == CurveSides::Curve) return along(start, s);
    const Vec3 other = image(along(image(start), s));
    return side == CurveSides::Image ? other : Vec3(0.5 * (along(start, s) + other));
  }

 private:
  Vec3 along(const Vec3& start, double s) const {
    return middle_ + curve_.at(s) - path_.curve.front() + curve_.turnTo(s) * (start - middle_);
  }
  Vec3 image(const Vec3& p) const {
    return p - 2 * (p - path_.sides->point).dot(path_.sides->normal) * path_.sides->normal;
  }

  const ExtrudePath& path_;
  Curve curve_;
  Vec3 middle_ = Vec3::Zero();
  std::map<std::uint32_t, std::uint8_t> side_;  // by the tips' vertices
};

/// Extrudes once by the given offsets of the tips' vertices; what it made, by parent.
Result<Created> layerBy(HairMesh& mesh, std::span<const BundleId> bundles,
                        const std::map<std::uint32_t, Vec3>& offsets) {
  ExtrudeOptions options;
  options.offsets.assign(mesh.vertices().size(), Vec3::Zero());
  for (const auto& [v, offset] : offsets) options.offsets[v] = offset;
  return extrudeFaces(mesh, bundles, options);
}

}  // namespace

Result<Created> extrudeAlong(HairMesh& mesh, std::span<const BundleId> bundles, const ExtrudePath& path) {
  COIF_TRY(check(path));
  if (path.sides && path.sides->of.size() != bundles.size())
    return refuse("there must be one side a bundle", "sides");
  COIF_ASSIGN(auto directions, tipDirections(mesh, bundles));
  const Carrier carrier(mesh, bundles, path);
  if (!path.curve.empty() && !(carrier.length() > 0)) return refuse("the curve has no length", "curve");
  std::map<std::uint32_t, std::uint32_t> tips;  // what each vertex grew from
  for (const auto& [v, direction] : directions) tips[v] = v;

  HairMesh grown = mesh;
  Created all;
  for (std::uint32_t layer = 1; layer <= path.layers; ++layer) {
    std::map<std::uint32_t, Vec3> offsets;
    for (auto& [v, direction] : directions) {
      if (path.curve.empty()) {
        direction = bent(direction, path);
        offsets[v] = path.length / path.layers * direction;
      } else {
        const double s = carrier.length() * layer / path.layers;
        offsets[v] = carrier.carried(tips[v], mesh.position(tips[v]), s) - grown.position(v);
      }
    }
    COIF_ASSIGN(const Created created, layerBy(grown, bundles, offsets));
    std::map<std::uint32_t, Vec3> nextDirections;
    std::map<std::uint32_t, std::uint32_t> nextTips;
    for (VertexId id : created.vertices) {
      const std::uint32_t v = grown.indexOf(id), parent = grown.vertices()[v].parent;
      nextDirections[v] = directions[parent];
      nextTips[v] = tips[parent];
    }
    directions = std::move(nextDirections), tips = std::move(nextTips);
    all.faces = created.faces;
    all.vertices.insert(all.vertices.end(), created.vertices.begin(), created.vertices.end());
  }
  mesh = std::move(grown);
  return all;
}

}  // namespace coif
