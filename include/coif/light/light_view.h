// How a light sees the hair: the projection that every shadow map shares, on the CPU and on the GPU.
#pragma once

#include "coif/base/vec.h"
#include "coif/scalp/polygon_mesh.h"

namespace coif {

/// A square map of `size` texels. Texel (i, j) covers [i, i + 1) × [j, j + 1); depth grows away from the
/// light. A distant light looks along `forward`, orthographically; a point light is a pinhole at `eye`.
struct LightView {
  Vec3 right = Vec3::UnitX(), up = Vec3::UnitY(), forward = -Vec3::UnitZ();  ///< orthonormal, right-handed:
                                                                             ///< right × up = −forward
  Vec3 eye = Vec3::Zero();  ///< point light: its position; distant: the middle of the map's near plane
  bool perspective = false;
  double texel = 1;       ///< distant: width of a texel in scene units; point light: at distance 1
  double depthRange = 1;  ///< depth of the farthest point of the box it was made for
  int size = 512;         ///< texels a side

  /// (x, y) in texels, z the depth in scene units: along `forward` for both kinds. For a point light, points
  /// at or behind the eye have z <= 0 and no meaningful (x, y).
  Vec3 project(const Vec3& world) const;
  /// Width of a texel in scene units at a depth.
  double texelAt(double depth) const { return perspective ? texel * depth : texel; }
};

/// Sees the whole box from a distant light; `toLight` need not be unit length. An empty box gives a unit one.
LightView distantLightView(const Vec3& toLight, const Box& box, int size);
/// Sees the whole box from a point outside it. From inside the box, or nearer than a hundredth of its
/// diagonal, no single map can: the field of view is then held at 150° about the box's middle and the rest is
/// unshadowed.
LightView pointLightView(const Vec3& position, const Box& box, int size);

}  // namespace coif
