// Bounding-box tree over triangles with dipole moments: nearest point, ray and winding number.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "coif/base/context.h"
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
  /// libigl's box tree, flattened, a few triangles a leaf. Empty where it was cancelled. Cost: O(T log T),
  /// about 120 bytes a triangle.
  explicit TriangleTree(std::vector<Triangle> triangles, const Context& context = {});

  bool empty() const { return nodes_.empty(); }
  /// Ties go to the triangle of lowest index, so the answer does not depend on the tree.
  Hit nearest(const Vec3& point) const;
  Hit intersect(const Vec3& origin, const Vec3& direction, double maxT) const;
  /// Barill et al. 2018: nodes farther than `beta` radii by their moments up to the second order, triangles
  /// by their solid angle. The first call finds the moments: O(T), up to 100 bytes a triangle more.
  double windingNumber(const Vec3& point, double beta) const;

 private:
  struct Node {
    Vec3 lo, hi;
    std::uint32_t right = kNone;  ///< the left child is the next node; kNone: a leaf
    std::uint32_t first = 0, count = 0;
  };
  /// Moments of a node's triangles for points far away.
  struct Far {
    double area = 0;
    Vec3 centre = Vec3::Zero();  ///< area-weighted centroid
    double radius = 0;           ///< at least that of the triangles about the centre
    Vec3 dipole = Vec3::Zero();  ///< Σ area vectors
    Mat3 moment = Mat3::Zero();  ///< ∫ d nᵀ, d from the centre
    std::array<Mat3, 3> second{Mat3::Zero(), Mat3::Zero(), Mat3::Zero()};  ///< [k]: ∫ d dᵀ n_k
  };
  struct Moments {
    std::once_flag found;
    std::vector<std::uint32_t> of;  ///< by node: into far; kNone: a few triangles, always opened
    std::vector<Far> far;
  };
  void copyTree(const void* tree);
  void findMoments() const;
  Far sumOf(const Node& node) const;
  Far joined(const Far& a, const Far& b, const Node& node) const;

  std::vector<Triangle> triangles_;    // in the order of the leaves
  std::vector<std::uint32_t> number_;  // what the caller calls them
  std::vector<Node> nodes_;            // parents before children
  std::unique_ptr<Moments> moments_;
};

/// The nearest point of a triangle, as barycentrics; right for triangles that are segments or points too.
Vec3 nearestOnTriangle(const TriangleTree::Triangle& triangle, const Vec3& point);

}  // namespace coif
