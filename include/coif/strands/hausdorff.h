// How far two curves are apart: the truth that samplings are judged by.
#pragma once

#include <span>

#include "coif/base/vec.h"

namespace coif {

/// Greatest distance from a point of `from` to the polyline through `to` (>= 1 point); 0 when `from` is
/// empty. Exact but for rounding; cost points × segments, less where neighbours agree.
double oneSidedHausdorff(std::span<const Vec3> from, std::span<const Vec3> to);

/// Hausdorff distance of two polylines: from vertices to segments both ways, which is exact when the finer
/// one's segments are short against the result.
double hausdorff(std::span<const Vec3> a, std::span<const Vec3> b);

}  // namespace coif
