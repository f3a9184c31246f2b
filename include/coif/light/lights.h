// Where light comes from.
#pragma once

#include "coif/base/vec.h"

namespace coif {

/// A distant light. `direction` points to the light, of any length but zero; linear RGB radiance times solid
/// angle, so that a white diffuse surface facing it reflects color / π.
struct Light {
  Vec3 direction = Vec3::UnitY();
  Vec3f color = Vec3f::Ones();
};

/// Key, fill and rim, and the light of the surroundings from above and below.
struct Lights {
  Light key{Vec3(-0.55, 0.65, 0.62), Vec3f(3.3f, 3.1f, 2.8f)};
  Light fill{Vec3(0.85, 0.15, 0.55), Vec3f(0.50f, 0.54f, 0.62f)};
  Light rim{Vec3(0.55, 0.55, -0.8), Vec3f(2.3f, 2.35f, 2.5f)};
  Vec3f skyColor = Vec3f(0.55f, 0.58f, 0.64f);
  Vec3f groundColor = Vec3f(0.20f, 0.18f, 0.17f);
  bool followCamera =
      true;  ///< directions are (right, up, towards the eye), up being the camera's; else the scene's
};

}  // namespace coif
