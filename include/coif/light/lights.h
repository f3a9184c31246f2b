// Where light comes from.
#pragma once

#include <memory>
#include <vector>

#include "coif/base/vec.h"

namespace coif {

struct FloatImage;

/// A distant light. `direction` points to the light, of any length but zero; linear RGB radiance times solid
/// angle, so that a white diffuse surface facing it reflects color / π.
struct Light {
  Vec3 direction = Vec3::UnitY();
  Vec3f color = Vec3f::Ones();
};

/// A light at a place in the scene; linear RGB radiance times area, so that a white diffuse surface facing it
/// at distance d reflects color / (π d²).
struct PointLight {
  Vec3 position = Vec3::Zero();
  Vec3f color = Vec3f::Ones();
};

/// Key, fill and rim, and the light of the surroundings from above and below.
struct Lights {
  Light key{Vec3(-0.55, 0.65, 0.62), Vec3f(3.3f, 3.1f, 2.8f)};
  Light fill{Vec3(0.85, 0.15, 0.55), Vec3f(0.50f, 0.54f, 0.62f)};
  Light rim{Vec3(0.55, 0.55, -0.8), Vec3f(2.3f, 2.35f, 2.5f)};
  Vec3f skyColor = Vec3f(0.55f, 0.58f, 0.64f);     ///< radiance of the upper half of the sphere around
  Vec3f groundColor = Vec3f(0.20f, 0.18f, 0.17f);  ///< and of the lower
  bool followCamera =
      true;  ///< directions are (right, up, towards the eye), up being the camera's; else the scene's
  std::vector<Light> more;         ///< further distant lights
  std::vector<PointLight> points;  ///< always in the scene's frame
  /// Radiance of the surroundings instead of sky and ground, or null. Latitude and longitude: the top row is
  /// up, the middle column lies along −forward of the camera (followCamera) or the scene's front, columns to
  /// the right turn to the right as seen from inside looking there. Constant over each texel; alpha ignored.
  std::shared_ptr<const FloatImage> surroundings;
};

/// The unit vector to a distant light in the scene's frame; zero for a direction without length. With
/// `followCamera`, right, up and forward are the camera's.
inline Vec3 towardsLight(const Light& light, bool followCamera, const Vec3& right, const Vec3& up,
                         const Vec3& forward) {
  const Vec3& d = light.direction;
  return (followCamera ? Vec3(d.x() * right + d.y() * up - d.z() * forward) : d).stableNormalized();
}

}  // namespace coif
