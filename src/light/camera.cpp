#include "coif/light/camera.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace coif {

Camera frameBox(const Box& box, UpAxis upAxis, double azimuthDeg, double elevationDeg, double aspect) {
  constexpr double kRadians = 3.14159265358979323846 / 180;
  const double azimuth = azimuthDeg * kRadians, elevation = std::clamp(elevationDeg, -89.0, 89.0) * kRadians;
  const Vec3 back(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                  std::cos(azimuth) * std::cos(elevation));
  const auto toScene = [&](const Vec3& v) { return upAxis == UpAxis::Y ? v : Vec3(v.x(), -v.z(), v.y()); };
  Camera camera;
  camera.target = 0.5 * (box.lo + box.hi);
  camera.up = toScene(Vec3::UnitY());
  const Vec3 towardsEye = toScene(back);
  const Vec3 right = camera.up.cross(towardsEye).normalized(), up = towardsEye.cross(right);
  // The distance at which every corner of the box lies inside the view, with a margin.
  const double slopeY = std::tan(0.5 * camera.fovDeg * kRadians) / 1.06,
               slopeX = slopeY * std::max(aspect, 1e-3);
  double distance = 0;
  for (int c = 0; c < 8; ++c) {
    const Vec3 corner((c & 1 ? box.hi : box.lo).x(), (c & 2 ? box.hi : box.lo).y(),
                      (c & 4 ? box.hi : box.lo).z());
    const Vec3 d = corner - camera.target;
    const double reach = std::max(std::abs(d.dot(right)) / slopeX, std::abs(d.dot(up)) / slopeY);
    distance = std::max(distance, reach + d.dot(towardsEye));
  }
  camera.eye = camera.target + std::max(distance, 1e-6 + 1e-6 * camera.target.norm()) * towardsEye;
  return camera;
}

Result<CameraFrame> frameOf(const Camera& camera) {
  const Vec3 forward = camera.target - camera.eye;
  const Vec3 right = forward.cross(camera.up);
  const double spanned = right.norm() / std::max(forward.norm() * camera.up.norm(), 1e-300);
  if (!camera.eye.allFinite() || !forward.allFinite() || !camera.up.allFinite() || !(spanned > 1e-6)) {
    return makeError(ErrorCode::InvalidArgument,
                     "the camera's eye, target and up must be finite and span a plane");
  }
  if (!(camera.fovDeg > 0.01 && camera.fovDeg < 179)) {
    return makeError(ErrorCode::InvalidArgument,
                     "the camera's angle of view must lie between 0.01 and 179 degrees");
  }
  CameraFrame frame;
  frame.eye = camera.eye;
  frame.forward = forward.normalized();
  frame.right = right.normalized();
  frame.up = frame.right.cross(frame.forward);
  frame.slopeY = std::tan(camera.fovDeg * 3.14159265358979323846 / 360);
  return frame;
}

}  // namespace coif
