#include "coif/simulate/collider.h"

#include <algorithm>

namespace coif {

RigidPose between(const RigidPose& from, const RigidPose& to, double t) {
  if (from == to || t <= 0) return from;
  if (t >= 1) return to;
  const Eigen::Quaterniond a(from.rotation), b(to.rotation);
  return {a.slerp(t, b).toRotationMatrix(), from.position + t * (to.position - from.position)};
}

namespace {

bool fromAxis(const Vec3& local, const Vec3& foot, double radius, double& distance, Vec3& gradient) {
  const Vec3 out = local - foot;
  const double length = out.norm();
  if (!(length < 1e300)) return false;
  gradient = length > 0 ? Vec3(out / length) : Vec3(Vec3::UnitY());
  distance = length - radius;
  return true;
}

}  // namespace

bool SphereCollider::sample(const Vec3& local, double& distance, Vec3& gradient) const {
  return fromAxis(local, centre_, radius_, distance, gradient);
}

bool CapsuleCollider::sample(const Vec3& local, double& distance, Vec3& gradient) const {
  const Vec3 axis = b_ - a_;
  const double square = axis.squaredNorm();
  const double t = square > 0 ? std::clamp((local - a_).dot(axis) / square, 0.0, 1.0) : 0;
  return fromAxis(local, a_ + t * axis, radius_, distance, gradient);
}

}  // namespace coif
