// Fixed-size vectors and the row-major arrays that pass between rooms.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>  // cross products
#include <cstdint>
#include <limits>

namespace coif {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Vec2f = Eigen::Vector2f;
using Vec3f = Eigen::Vector3f;
using Mat3 = Eigen::Matrix3d;

/// "No such index": what a parent, a neighbour or a group is when there is none.
inline constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

}  // namespace coif
