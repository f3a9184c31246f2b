// What a head stands on.
#pragma once

#include "coif/scalp/polygon_mesh.h"

namespace coif {

/// A diffuse disc to stand on, seen from both sides.
struct Ground {
  Vec3 point = Vec3::Zero(), normal = Vec3::UnitY();  ///< normal of any length but zero
  double radius = 1e30;                               ///< scene units
  Vec3f color = Vec3f::Constant(0.5f);                ///< albedo, 0 … 1
};

/// Errors: InvalidArgument for a point that is not finite, a normal without length, a radius below 0 or a
/// colour outside 0 … 1.
Status validate(const Ground& ground);

/// A dark disc under the lowest point of a head, its radius one and a half times the head's height.
Ground groundUnder(const PolygonMesh& head, UpAxis up);

}  // namespace coif
