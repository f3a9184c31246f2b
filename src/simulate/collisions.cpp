#include "coif/simulate/collisions.h"

#include <bit>
#include <cmath>

#include "coif/base/check.h"
#include "coif/base/parallel.h"

namespace coif {

namespace {
constexpr std::size_t kMaxSolids = 64;
constexpr int kSweepSteps = 64;  // of sphere tracing; each goes at least a quarter of the thickness
}  // namespace

std::size_t CollisionField::addCollider(const Collider& collider, const RigidPose& pose) {
  COIF_CHECK(solids_.size() < kMaxSolids, "a collision field takes 64 solids");
  solids_.push_back({&collider, pose, pose});
  return solids_.size() - 1;
}

void CollisionField::setMotion(std::size_t index, const RigidPose& start, const RigidPose& end) {
  solids_.at(index).start = start;
  solids_.at(index).end = end;
}

const char* CollisionField::idleReason() const {
  if (active()) return "";
  return solids_.empty() ? "there is nothing to collide with" : "no node is near a solid";
}

bool CollisionField::firstTouch(const Collider& collider, const Vec3& from, const Vec3& to, double thickness,
                                Vec3& touch, Vec3& normal) {
  const double way = (to - from).norm();
  double gone = 0;
  for (int step = 0; step < kSweepSteps && gone <= way; ++step) {
    const Vec3 at = from + gone / way * (to - from);
    double distance = 0;
    if (!collider.sample(at, distance, normal)) {
      gone += std::max(collider.reach() - thickness, way / kSweepSteps);
      continue;
    }
    if (distance <= thickness) {
      touch = at - (distance - thickness) * normal;
      return true;
    }
    gone += std::max(distance - thickness, 0.25 * thickness);
  }
  return false;
}

void CollisionField::slideOn(const Solid& solid, const Vec3& position, const Vec3& normal, double depth,
                             double mass, double timeStep, Contact& contact) const {
  if (options_.friction <= 0 && options_.damping <= 0) return;
  contact.slides = true;
  contact.slideNormal = normal;
  contact.load = mass * options_.stiffness * depth;
  contact.base = (solid.end.world(solid.start.local(position)) - position) / timeStep;
}

CollisionField::Contact CollisionField::contactOf(const NodeView& nodes, std::size_t node,
                                                  double timeStep) const {
  Contact contact;
  const Vec3 position = nodes.positions[node];
  const double thickness = thickness_[node];
  const Vec3 ahead = position + timeStep * nodes.velocities[node];
  if (!position.allFinite() || !ahead.allFinite() || (!exempt_.empty() && exempt_[node])) return contact;
  double deepest = 0;
  for (std::size_t s = 0; s < solids_.size(); ++s) {
    const Solid& solid = solids_[s];
    const Vec3 from = solid.start.local(position), to = solid.end.local(ahead);
    const double way = (to - from).norm();
    double distance = 0;
    Vec3 normal;
    const bool known = solid.collider->sample(from, distance, normal);
    if (!known && solid.collider->reach() > 2 * way + 2 * thickness) {
      // Beyond reach at the start and slower than half of it: nothing to meet unless it is fast.
      continue;
    }
    // Twice the way: what forces may add within the step.
    if (known && distance > 2 * way + 2 * thickness) continue;
    const bool touching = known && distance < thickness;
    if (touching && thickness - distance > deepest) {
      deepest = thickness - distance;
      slideOn(solid, position, solid.end.rotation * normal, deepest, nodes.masses[node], timeStep, contact);
    }
    const bool leaving = touching && (to - from).dot(normal) >= 0;
    Vec3 touch;
    if (!contact.plane && !leaving && way > 0.5 * thickness &&
        firstTouch(*solid.collider, from, to, thickness, touch, normal)) {
      contact.plane = true;
      contact.normal = solid.end.rotation * normal;
      contact.offset = contact.normal.dot(solid.end.world(touch));
    } else {
      contact.solids |= std::uint64_t{1} << s;
    }
  }
  return contact;
}

void CollisionField::prepare(const NodeView& start, double, double timeStep, const Context& context) {
  inverseStep_ = 1 / timeStep;
  near_ = swept_ = 0;
  if (solids_.empty()) return;
  const std::size_t count = start.positions.size();
  masses_.assign(start.masses.begin(), start.masses.end());
  thickness_.assign(count, options_.band);
  for (std::size_t i = 0; i < start.radii.size(); ++i) thickness_[i] += start.radii[i];
  contacts_.resize(count);
  parallelFor(context, count, 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) contacts_[i] = contactOf(start, i, timeStep);
  });
  for (const Contact& contact : contacts_) {
    near_ += contact.plane || contact.solids != 0;
    swept_ += contact.plane;
  }
}

/// How far inside solid `solid` the node is at `position`, <= 0 outside; its outward normal in the world.
double CollisionField::depth(std::size_t solid, std::uint32_t node, const Vec3& position,
                             Vec3& normal) const {
  const RigidPose& pose = solids_[solid].end;
  double distance = 0;
  Vec3 local;
  if (!solids_[solid].collider->sample(pose.local(position), distance, local)) return 0;
  normal = pose.rotation * local;
  return thickness_[node] - distance;
}

void CollisionField::add(std::uint32_t node, const Vec3& position, const Vec3& velocity, Vec3& force,
                         Mat3& stiffness) const {
  const Contact& contact = contacts_[node];
  const double k = masses_[node] * options_.stiffness;
  const auto push = [&](double in, const Vec3& normal) {
    if (!(in > 0)) return;
    force += k * in * normal;
    stiffness += k * normal * normal.transpose();
  };
  if (contact.plane) push(contact.offset - contact.normal.dot(position), contact.normal);
  Vec3 normal;
  for (std::uint64_t left = contact.solids; left != 0; left &= left - 1) {
    const double in = depth(std::size_t(std::countr_zero(left)), node, position, normal);
    push(in, normal);
  }
  if (!contact.slides) return;
  const Vec3& n = contact.slideNormal;
  const Vec3 relative = velocity - contact.base;
  const double along = relative.dot(n);
  if (options_.friction > 0 && contact.load > 0) {
    const Vec3 sliding = relative - along * n;
    const double rate = options_.friction * contact.load / std::max(sliding.norm(), options_.slipSpeed);
    force -= rate * sliding;
    stiffness += rate * inverseStep_ * (Mat3::Identity() - n * n.transpose());
  }
  if (options_.damping > 0 && along < 0) {
    const double rate = masses_[node] * options_.damping;
    force -= rate * along * n;
    stiffness += rate * inverseStep_ * n * n.transpose();
  }
}

double CollisionField::energy(std::uint32_t node, const Vec3& position) const {
  const Contact& contact = contacts_[node];
  double sum = 0;
  if (contact.plane) {
    const double in = std::max(0.0, contact.offset - contact.normal.dot(position));
    sum += in * in;
  }
  Vec3 normal;
  for (std::uint64_t left = contact.solids; left != 0; left &= left - 1) {
    const double in = std::max(0.0, depth(std::size_t(std::countr_zero(left)), node, position, normal));
    sum += in * in;
  }
  return 0.5 * masses_[node] * options_.stiffness * sum;
}

}  // namespace coif
