// One path at a time.
#pragma once

#include <optional>
#include <vector>

#include "coif/base/random.h"
#include "coif/light/fibre.h"
#include "coif/light/path_tracer.h"
#include "light/light_sampler.h"
#include "light/ray_scene.h"

namespace coif::light {

/// All that a path needs to know; const while paths run.
struct PathWorld {
  RayScene rays;
  LightSampler lights;
  std::vector<FibreScattering> fibres;
  std::vector<std::uint16_t> fibreOf;  ///< of each strand, or empty: all the first
  std::optional<Ground> ground;        ///< unit normal
  Vec3 headColor = Vec3::Zero();
  double offset = 0;  ///< how far a path starts above the head and the ground: float's rounding

  int maxBounces = 1024, rouletteStart = 4;
  bool showSurroundings = false;
};

struct PathResult {
  Vec3 radiance = Vec3::Zero();
  double alpha = 0;
  std::uint32_t rays = 0, shadowRays = 0;
  bool truncated = false;
};

PathResult tracePath(const PathWorld& world, const Vec3& eye, const Vec3& direction,
                     const CounterRandom& random);

}  // namespace coif::light
