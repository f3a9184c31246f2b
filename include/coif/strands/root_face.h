// A root face prepared for carrying roots: its plane, its area, weights of points on it.
//
// Weights are computed once, on the root face, in its Newell plane, and used on every layer (hair mesh
// specification; faces need not be planar and their copies on higher layers have other shapes). The root
// itself is Σ λ_i v_i, so faces that share an edge agree along it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "coif/base/vec.h"

namespace coif {

/// Immutable. Corners in order; the plane's first axis runs along the first side, so the plane moves with the
/// face.
class RootFace {
 public:
  /// >= 3 finite corners. A face whose projection crosses itself is triangulated by ear clipping and uses
  /// barycentric coordinates in its triangles; one without an area is barren.
  explicit RootFace(std::span<const Vec3> corners);

  bool barren() const { return area_ <= 0; }
  bool triangulated() const { return triangulated_; }
  double area() const { return area_; }                       ///< of the projection; scene units squared
  std::span<const Vec2> polygon() const { return polygon_; }  ///< in the plane, relative to the first corner
  const Vec2& lo() const { return lo_; }                      ///< of the polygon's box
  const Vec2& hi() const { return hi_; }

  /// Where a point of space falls in the plane.
  Vec2 project(const Vec3& point) const;
  /// Inside the polygon (or one of its triangles); a point on the border may go either way.
  bool contains(const Vec2& point) const;
  /// The point at (u, v) of the unit square under an area-preserving map onto the face's triangles.
  Vec2 fromSquare(double u, double v) const;
  /// Weights of a point of the plane, one a corner; true when one of them is negative.
  bool weights(const Vec2& point, std::span<double> out) const;

 private:
  void layDown(std::span<const Vec3> corners);
  void triangulateFace(std::span<const Vec3> corners);
  bool crossesItself() const;
  bool isConvex() const;

  Vec3 origin_ = Vec3::Zero(), axisU_ = Vec3::UnitX(), axisV_ = Vec3::UnitY();
  std::vector<Vec2> polygon_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<double> triangleEnds_;  ///< running sum of triangle areas
  Vec2 lo_ = Vec2::Zero(), hi_ = Vec2::Zero();
  double area_ = 0;
  bool triangulated_ = false, convex_ = true;
};

}  // namespace coif
