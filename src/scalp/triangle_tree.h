// Bounding-box tree over triangles with dipole moments: nearest point, ray and winding number.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "coif/base/vec.h"

namespace coif {

/// Immutable; queries are thread-safe. Works in the coordinates it is given; the caller scales to about 1.
class TriangleTree {
 public:
  using Triangle = std::array<Vec3, 3>;
  struct Hit {
    std::uint32_t triangle = kNone;
    Vec3 barycentric = Vec3::Zero();
    double distance = 0;  ///< or ray parameter
  };

  TriangleTree() = default;
  explicit TriangleTree(std::vector<Triangle> triangles);

  bool empty() const { return nodes_.empty(); }
  /// Ties go to the triangle of lowest index, so the answer does not depend on the tree.
  Hit nearest(const Vec3& point) const;
  Hit intersect(const Vec3& origin, const Vec3& direction, double maxT) const;
  /// Barill et al. 2018: nodes farther than `beta` radii by their moments up to the second order, triangles
  /// by their solid angle.
  double windingNumber(const Vec3& point, double beta) const;

 private:
  struct Node {
    Vec3 lo, hi;
    std::uint32_t left = kNone, right = kNone, triangle = kNone;
    std::uint32_t far = kNone;  ///< index into far_; nodes of a few triangles have none and are always opened
  };
  /// Moments of a node's triangles for points far away.
  struct Far {
    Vec3 centre = Vec3::Zero();  ///< area-weighted centroid
    double radius = 0;           ///< of the triangles about the centre
    Vec3 dipole = Vec3::Zero();  ///< Σ area vectors
    Mat3 moment = Mat3::Zero();  ///< ∫ d nᵀ, d from the centre
    std::array<Mat3, 3> second{Mat3::Zero(), Mat3::Zero(), Mat3::Zero()};  ///< [k]: ∫ d dᵀ n_k
  };
  std::uint32_t copyTree(const void* tree);
  Far farField(std::span<const std::uint32_t> triangles) const;
  void gather(std::uint32_t node, std::vector<std::uint32_t>& below);

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;  // parents before children
  std::vector<Far> far_;
};

/// The nearest point of a triangle, as barycentrics; right for triangles that are segments or points too.
Vec3 nearestOnTriangle(const TriangleTree::Triangle& triangle, const Vec3& point);

}  // namespace coif
