#include "coif/scene/head_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace coif {
namespace {

constexpr double kEaseSeconds = 0.5;

/// 0 at 0, 1 from kEaseSeconds on, no jump of the velocity.
double ease(double seconds) {
  const double s = std::clamp(seconds / kEaseSeconds, 0.0, 1.0);
  return s * s * (3 - 2 * s);
}

/// Rounds done after some seconds: the integral of ease, so that the speed grows from nothing.
double easedTime(double seconds) {
  const double s = std::clamp(seconds / kEaseSeconds, 0.0, 1.0);
  return kEaseSeconds * (s * s * s - 0.5 * s * s * s * s) + std::max(seconds - kEaseSeconds, 0.0);
}

Box rootBox(const HairMesh& mesh) {
  std::vector<Vec3> roots;
  for (const HairVertex& v : mesh.vertices()) {
    if (v.layer == 0) roots.push_back(v.position);
  }
  return roots.empty() ? Box{Vec3::Zero(), Vec3::Zero()} : bounds(roots);
}

}  // namespace

Result<std::vector<RigidPose>> headPoses(const HeadMoveSettings& settings, const HairMesh& mesh,
                                         UpAxis upAxis, std::size_t frames, double framesPerSecond) {
  if (!std::isfinite(settings.angleDeg) || !(settings.timesPerSecond > 0 && settings.timesPerSecond <= 20)) {
    return makeError(ErrorCode::InvalidArgument, "the head moves by a finite angle, up to 20 times a second");
  }
  if (!(framesPerSecond > 0)) {
    return makeError(ErrorCode::InvalidArgument, "the frames a second must be above 0");
  }
  std::vector<RigidPose> poses(frames);
  if (settings.move == HeadMove::Still) return poses;
  const int upIndex = upAxis == UpAxis::Y ? 1 : 2;
  const Box box = rootBox(mesh);
  Vec3 pivot = 0.5 * (box.lo + box.hi);
  if (settings.move == HeadMove::Nod) pivot[upIndex] = box.lo[upIndex];
  const Vec3 axis = settings.move == HeadMove::Nod ? Vec3(Vec3::UnitX()) : Vec3(Vec3::Unit(upIndex));
  constexpr double kTurn = 2 * std::numbers::pi;
  for (std::size_t f = 0; f < frames; ++f) {
    const double seconds = double(f) / framesPerSecond;
    const double angle = settings.move == HeadMove::Turn
                             ? kTurn * settings.timesPerSecond * easedTime(seconds)
                             : settings.angleDeg * std::numbers::pi / 180 * ease(seconds) *
                                   std::sin(kTurn * settings.timesPerSecond * seconds);
    const Mat3 rotation = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    poses[f] = {rotation, pivot - rotation * pivot};
  }
  return poses;
}

}  // namespace coif
