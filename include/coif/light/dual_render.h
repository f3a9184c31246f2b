// Pictures by dual scattering on the CPU: what the eye's rays meet first, shaded by dual_scattering.h.
//
// Global scattering by ray shooting (every fibre between the point and the light is counted), or from forward
// scattering maps, one a light. Fibres are shaded as far fields, so a pixel that a fibre fills shows its
// mean.
#pragma once

#include <span>

#include "coif/base/random.h"
#include "coif/light/camera.h"
#include "coif/light/dual_scattering.h"
#include "coif/light/forward_scattering.h"
#include "coif/light/image.h"
#include "coif/light/lights.h"
#include "coif/light/strand_shooter.h"

namespace coif {

/// Distant lights alone: key, fill, rim and more; those of no colour are left out. The head, if the shooter
/// has one, is black.
struct DualRenderScene {
  const StrandShooter* strands = nullptr;
  const DualScattering* hair = nullptr;
  Camera camera;
  Lights lights;
};

struct DualRenderOptions {
  int width = 512, height = 512;
  int samplesPerPixel = 4;  ///< jittered, >= 1
  std::uint64_t seed = 0;
  /// Rays each way, forwards to the fibre that scatters on to a point and backwards through those that return
  /// light to it, that measure how much hair there is around; 0: the straight path to the light and the
  /// density factors alone. Not with maps.
  int surroundingRays = 4;
  /// Empty: rays. Else one a light that shines, in the order key, fill, rim, more.
  std::span<const ForwardScatteringMap* const> maps;
};

/// The lights of a scene that shine, as unit vectors towards them and irradiances, in that order.
struct ShiningLight {
  Vec3 toLight = Vec3::UnitY();
  Vec3 irradiance = Vec3::Ones();
};
std::vector<ShiningLight> shiningLights(const Lights& lights, const CameraFrame& frame);

/// What reaches a point of `strand` from a light: every fibre on the way counted. `meetings` is scratch.
ForwardScattering shootForward(const StrandShooter& strands, const DualScattering& hair, const Vec3& point,
                               std::uint32_t strand, const Vec3& toLight,
                               std::vector<StrandMeeting>& meetings);

/// The same with the hair around counted: `rays` directions, even over the half cone of the light's
/// inclination around `fibre` (its frame's columns, the axis first), reach for the fibre that scatters on to
/// the point; as many, away from the light, count the fibres behind and reach for the first. Those fibres get
/// their light along the straight path. Into `out`.
void shootAround(const StrandShooter& strands, const DualScattering& hair, const Vec3& point,
                 std::uint32_t strand, const Mat3& fibre, const Vec3& toLight, int rays,
                 const CounterRandom& random, std::vector<StrandMeeting>& meetings, SurroundingLight& out);

/// Mean radiance, alpha the share of rays that met something. Same bytes for any number of threads. Errors:
/// InvalidArgument (sizes, samples, a number of maps that is not that of the lights, the camera), Cancelled.
Result<FloatImage> renderDualScattering(const DualRenderScene& scene, const DualRenderOptions& options,
                                        const Context& context = {});

}  // namespace coif
