#include "coif/scene/navigation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace coif {
namespace {

constexpr double kRadians = std::numbers::pi / 180;

/// To a frame in which y is up and z points to the front, and back.
Vec3 toYUp(const Vec3& v, UpAxis upAxis) {
  return upAxis == UpAxis::Y ? v : Vec3(v.x(), v.z(), -v.y());
}
Vec3 fromYUp(const Vec3& v, UpAxis upAxis) {
  return upAxis == UpAxis::Y ? v : Vec3(v.x(), -v.z(), v.y());
}

}  // namespace

double azimuthDegOf(const Camera& camera, UpAxis upAxis) {
  const Vec3 back = toYUp(camera.eye - camera.target, upAxis);
  return std::atan2(back.x(), back.z()) / kRadians;
}

double elevationDegOf(const Camera& camera, UpAxis upAxis) {
  const Vec3 back = toYUp(camera.eye - camera.target, upAxis);
  return std::atan2(back.y(), std::hypot(back.x(), back.z())) / kRadians;
}

Camera orbit(const Camera& camera, UpAxis upAxis, double azimuthDeg, double elevationDeg) {
  const double azimuth = (azimuthDegOf(camera, upAxis) + azimuthDeg) * kRadians;
  const double elevation = std::clamp(elevationDegOf(camera, upAxis) + elevationDeg, -89.0, 89.0) * kRadians;
  const double distance = (camera.eye - camera.target).norm();
  Camera out = camera;
  out.up = fromYUp(Vec3::UnitY(), upAxis);
  out.eye =
      camera.target + distance * fromYUp(Vec3(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                                              std::cos(azimuth) * std::cos(elevation)),
                                         upAxis);
  return out;
}

Camera pan(const Camera& camera, double xPx, double yPx, int height) {
  const Vec3 back = camera.eye - camera.target;
  const double pixel = 2 * back.norm() * std::tan(0.5 * camera.fovDeg * kRadians) / std::max(height, 1);
  const Vec3 right = camera.up.cross(back).normalized(), up = back.cross(right).normalized();
  const Vec3 by = pixel * (-xPx * right + yPx * up);
  Camera out = camera;
  out.eye += by;
  out.target += by;
  return out;
}

Camera dolly(const Camera& camera, double factor) {
  Camera out = camera;
  out.eye = camera.target + factor * (camera.eye - camera.target);
  return out;
}

Camera withLens(const Camera& camera, double fovDeg) {
  Camera out = dolly(camera, std::tan(0.5 * camera.fovDeg * kRadians) / std::tan(0.5 * fovDeg * kRadians));
  out.fovDeg = fovDeg;
  return out;
}

}  // namespace coif
