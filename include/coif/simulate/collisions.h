// Contact of hair nodes with rigid solids: penalty with lagged friction, swept so that nothing is passed
// through.
#pragma once

#include <memory>
#include <vector>

#include "coif/simulate/collider.h"
#include "coif/simulate/force_field.h"

namespace coif {

struct CollisionOptions {
  /// Force per depth and mass, per time²; a node of weight m g rests at the depth g / stiffness.
  double stiffness = 1e4;
  double band = 0;      ///< contact begins this far outside, beside the node's radius
  double friction = 0;  ///< Coulomb's coefficient
  /// Below this speed of sliding, friction falls to 0 linearly; > 0 where there is friction.
  double slipSpeed = 1e-3;
  double damping = 0;  ///< rate at which approaching nodes lose speed along the normal, per time
};

/// E = ½ m k max(radius + band − d(x), 0)² over nodes and solids. Friction −μ N w/max(|w|, slip) acts on the
/// sliding velocity w relative to the moving solid, with the normal and N = m k depth of the step's start
/// (lagged). A node whose way at its starting velocity would meet the solid is held by the plane of the
/// first touch instead of by the distance at its end, so that thin solids stop it however long the step. The
/// stiffness k n nᵀ leaves out curvature, which makes it positive semi-definite. Only nodes that can reach a
/// solid within the step are looked at.
class CollisionField final : public ForceField {
 public:
  explicit CollisionField(const CollisionOptions& options) : options_(options) {}

  /// At most 64. Returns its index. The collider must outlive the field.
  std::size_t addCollider(const Collider& collider, const RigidPose& pose = {});
  /// How collider `index` moves in the coming step.
  void setMotion(std::size_t index, const RigidPose& start, const RigidPose& end);
  /// Nodes that never collide: roots, and what lies beneath the skin at rest. By node; empty: none.
  void exempt(std::vector<std::uint8_t> nodes) { exempt_ = std::move(nodes); }

  void prepare(const NodeView& start, double time, double timeStep, const Context& context) override;
  void add(std::uint32_t node, const Vec3& position, const Vec3& velocity, Vec3& force,
           Mat3& stiffness) const override;
  double energy(std::uint32_t node, const Vec3& position) const override;
  bool active() const override { return near_ > 0; }
  const char* idleReason() const override;

  std::size_t nearCount() const { return near_; }    ///< nodes looked at this step
  std::size_t sweptCount() const { return swept_; }  ///< of these, held by a plane of first touch

 private:
  struct Solid {
    const Collider* collider;
    RigidPose start, end;
  };
  /// What a node meets; at most one solid by a plane, the others by distance.
  struct Contact {
    std::uint64_t solids = 0;  ///< bits: by distance
    bool plane = false;        ///< held by normal · x >= offset + thickness
    bool slides = false;       ///< friction acts, with the velocity `base` of the solid there
    Vec3 normal = Vec3::Zero();
    double offset = 0;
    Vec3 slideNormal = Vec3::Zero(), base = Vec3::Zero();
    double load = 0;  ///< lagged normal force
  };

  Contact contactOf(const NodeView& nodes, std::size_t node, double timeStep) const;
  void slideOn(const Solid& solid, const Vec3& position, const Vec3& normal, double depth, double mass,
               double timeStep, Contact& contact) const;
  /// First touch of the way from `from` to `to` (in the solid's frame) with the surface at `thickness`.
  static bool firstTouch(const Collider& collider, const Vec3& from, const Vec3& to, double thickness,
                         Vec3& touch, Vec3& normal);
  double depth(std::size_t solid, std::uint32_t node, const Vec3& position, Vec3& normal) const;

  CollisionOptions options_;
  std::vector<Solid> solids_;
  std::vector<std::uint8_t> exempt_;
  std::vector<Contact> contacts_;
  std::vector<double> masses_, thickness_;
  double inverseStep_ = 0;
  std::size_t near_ = 0, swept_ = 0;
};

}  // namespace coif
