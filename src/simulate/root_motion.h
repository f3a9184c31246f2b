// Where roots and head are at a moment, from a HeadMotion.
#pragma once

#include "coif/simulate/simulation.h"

namespace coif::simulate {

class RootPath {
 public:
  /// Errors: InvalidArgument for sizes that do not fit or values that are not finite.
  static Result<RootPath> create(const HairMesh& mesh, const HeadMotion& motion);

  std::size_t frames() const { return poses_.size(); }
  bool still() const { return poses_.size() <= 1; }
  /// At `time` in frames.
  RigidPose pose(double time) const;
  /// Position and turn (relative to rest) of a layer-0 vertex.
  void root(std::uint32_t vertex, double time, Vec3& position, Mat3& turn) const;
  /// The same of a point that is at `rest` and fixed to layer-0 vertices by weights, Σ = 1.
  void point(std::span<const std::uint32_t> vertices, std::span<const double> weights, const Vec3& rest,
             double time, Vec3& position, Mat3& turn) const;

 private:
  Vec3 where(std::uint32_t root, double time) const;  ///< with roots_ given

  std::vector<RigidPose> poses_;
  std::vector<std::vector<Vec3>> roots_;            ///< by frame; empty: rigid
  std::vector<std::vector<std::uint32_t>> around_;  ///< by root: roots of the faces it is a corner of
  std::vector<std::uint32_t> rootOf_;               ///< by vertex
  std::vector<Vec3> rest_;                          ///< by root
};

/// The rotation and translation that take `from` to `to` with the least squared error (Kabsch 1976).
RigidPose bestFit(std::span<const Vec3> from, std::span<const Vec3> to);

}  // namespace coif::simulate
