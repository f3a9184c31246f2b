// The example head as an implicit surface.
#pragma once

#include "coif/base/vec.h"

namespace coif {

/// Centre of the skull and of the base, in centimetres: inner points to send rays from.
inline const Vec3 kHeadCentre(0, 14.5, -1.2);
inline const Vec3 kHeadBase(0, -7.5, -3.0);

/// Negative inside, zero on the head, positive outside; near the surface about the distance in centimetres.
/// Even in x to the bit.
double headField(const Vec3& p);

}  // namespace coif
