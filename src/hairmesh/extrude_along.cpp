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
  const Curve curve(path.curve);
  if (!path.curve.empty() && !(curve.length() > 0)) return refuse("the curve has no length", "curve");
  COIF_ASSIGN(auto directions, tipDirections(mesh, bundles));
  Vec3 middle = Vec3::Zero();
  for (const auto& [v, direction] : directions) middle += mesh.position(v) / double(directions.size());
  std::map<std::uint32_t, Vec3> starts;
  for (const auto& [v, direction] : directions) starts[v] = mesh.position(v);

  HairMesh grown = mesh;
  Created all;
  for (std::uint32_t layer = 1; layer <= path.layers; ++layer) {
    std::map<std::uint32_t, Vec3> offsets;
    for (auto& [v, direction] : directions) {
      if (path.curve.empty()) {
        direction = bent(direction, path);
        offsets[v] = path.length / path.layers * direction;
      } else {
        const double s = curve.length() * layer / path.layers;
        const Vec3 to = middle + curve.at(s) - path.curve.front() + curve.turnTo(s) * (starts[v] - middle);
        offsets[v] = to - grown.position(v);
      }
    }
    COIF_ASSIGN(const Created created, layerBy(grown, bundles, offsets));
    std::map<std::uint32_t, Vec3> nextDirections, nextStarts;
    for (VertexId id : created.vertices) {
      const std::uint32_t v = grown.indexOf(id), parent = grown.vertices()[v].parent;
      nextDirections[v] = directions[parent];
      nextStarts[v] = starts[parent];
    }
    directions = std::move(nextDirections), starts = std::move(nextStarts);
    all.faces = created.faces;
    all.vertices.insert(all.vertices.end(), created.vertices.begin(), created.vertices.end());
  }
  mesh = std::move(grown);
  return all;
}

}  // namespace coif
