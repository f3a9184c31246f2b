// What the document says of light and hair, as the renderers take it.
#include <cmath>
#include <numbers>

#include "coif/scene/scene.h"

namespace coif {

Lights lightsOf(const LightSettings& settings, UpAxis upAxis) {
  constexpr double kRadians = std::numbers::pi / 180;
  const double azimuth = settings.azimuthDeg * kRadians, elevation = settings.elevationDeg * kRadians;
  const Vec3 direction(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                       std::cos(azimuth) * std::cos(elevation));
  Lights out;
  out.followCamera = settings.followCamera;
  const auto inScene = [&](const Vec3& d) {
    return out.followCamera || upAxis == UpAxis::Y ? d : Vec3(d.x(), -d.z(), d.y());
  };
  out.key.direction = inScene(direction);
  out.fill.direction = inScene(out.fill.direction);
  out.rim.direction = inScene(out.rim.direction);
  out.key.color *= float(settings.key);
  out.fill.color *= float(settings.fill);
  out.rim.color *= float(settings.rim);
  out.skyColor *= float(settings.sky);
  out.groundColor *= float(settings.sky);
  return out;
}

FibreParameters fibreOf(const LookSettings& look) {
  FibreParameters out;
  out.longitudinalRoughness = look.longitudinalRoughness;
  out.azimuthalRoughness = look.azimuthalRoughness;
  return out;
}

}  // namespace coif
