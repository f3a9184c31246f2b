// What hair may not enter: spheres, capsules, the head as a narrow band of distances.
#pragma once

#include <memory>
#include <vector>

#include "coif/base/context.h"
#include "coif/base/result.h"
#include "coif/scalp/surface.h"

namespace coif {

/// Where a rigid thing is: world = rotation · local + position.
struct RigidPose {
  Mat3 rotation = Mat3::Identity();
  Vec3 position = Vec3::Zero();

  Vec3 world(const Vec3& local) const { return rotation * local + position; }
  Vec3 local(const Vec3& world) const { return rotation.transpose() * (world - position); }
  RigidPose operator*(const RigidPose& inner) const {
    return {rotation * inner.rotation, rotation * inner.position + position};
  }
  RigidPose inverse() const { return {rotation.transpose(), -(rotation.transpose() * position)}; }
  bool operator==(const RigidPose&) const = default;
};
/// The pose at fraction t in [0, 1] on the way: positions on a line, rotations on a great circle.
RigidPose between(const RigidPose& from, const RigidPose& to, double t);

/// A solid in its own frame. Thread-safe.
class Collider {
 public:
  virtual ~Collider() = default;
  /// Signed distance (negative inside) and its exact gradient at `local`; false when it is further than
  /// reach() or not known.
  virtual bool sample(const Vec3& local, double& distance, Vec3& gradient) const = 0;
  virtual double reach() const = 0;  ///< distances up to here are known
};

class SphereCollider final : public Collider {
 public:
  SphereCollider(const Vec3& centre, double radius) : centre_(centre), radius_(radius) {}
  bool sample(const Vec3& local, double& distance, Vec3& gradient) const override;
  double reach() const override { return 1e300; }

 private:
  Vec3 centre_;
  double radius_;
};

/// All points within `radius` of the segment a–b.
class CapsuleCollider final : public Collider {
 public:
  CapsuleCollider(const Vec3& a, const Vec3& b, double radius) : a_(a), b_(b), radius_(radius) {}
  bool sample(const Vec3& local, double& distance, Vec3& gradient) const override;
  double reach() const override { return 1e300; }

 private:
  Vec3 a_, b_;
  double radius_;
};

struct DistanceBandOptions {
  double cell = 0;   ///< 0: a 64th of the mesh's diagonal
  double reach = 0;  ///< how far outside distances are kept, 0: 3 cells; inside they are known everywhere
};

struct DistanceBandReport {
  std::size_t nodes = 0, bricks = 0;  ///< exact queries kept, bricks of 4³ cells in the band
  std::uint64_t bytes = 0;
  double seconds = 0;
  /// Greatest and root-mean-square |band − exact| at 2 000 random points in the band.
  double worstError = 0, rmsError = 0;
};

/// Distances and gradients of a surface at the nodes of a grid, in bricks near the surface only. Between
/// nodes d(x) = Σ w_i (d_i + ½ g_i·(x − x_i)) with trilinear w, exact for quadratics (error O(cell³) where
/// the surface is smooth, O(cell) within a cell of edges of its medial axis), and the exact gradient of that.
/// Deeper inside than the band: linear from the brick's centre, which leads out. Build: one exact query a
/// node, in parallel.
class DistanceBand final : public Collider {
 public:
  static Result<DistanceBand> build(const Surface& surface, const DistanceBandOptions& options = {},
                                    const Context& context = {});
  bool sample(const Vec3& local, double& distance, Vec3& gradient) const override;
  double reach() const override { return reach_; }
  double cell() const { return cell_; }
  const DistanceBandReport& report() const { return report_; }

 private:
  struct Node {
    float distance = 0;
    Vec3f gradient = Vec3f::Zero();
  };
  static constexpr long kBrick = 4;                  ///< cells along a brick
  static constexpr long kSide = kBrick + 1;          ///< nodes along a brick, both ends
  static constexpr std::uint32_t kFar = kNone;       ///< outside and out of reach
  static constexpr std::uint32_t kDeep = kNone - 1;  ///< inside and out of the band

  void measure(const Surface& surface);
  Vec3 brickCentre(std::size_t brick) const;

  Vec3 origin_ = Vec3::Zero();
  double cell_ = 1, reach_ = 0;
  long bricks_[3] = {0, 0, 0};
  std::vector<std::uint32_t> brickStart_;  ///< first node of a brick in the band / kSide³, kFar or kDeep
  std::vector<Node> centres_;              ///< by brick
  std::vector<Node> nodes_;                ///< kSide³ a brick in the band
  DistanceBandReport report_;
};

}  // namespace coif
