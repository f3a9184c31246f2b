#include "coif/light/ground.h"

#include <cmath>

namespace coif {

Status validate(const Ground& ground) {
  if (!ground.point.allFinite() || !(ground.normal.stableNormalized().norm() > 0.5) || !(ground.radius >= 0))
    return makeError(ErrorCode::InvalidArgument,
                     "the ground needs a point, a normal with length and a radius");
  if (!ground.color.allFinite() || ground.color.minCoeff() < 0 || ground.color.maxCoeff() > 1)
    return makeError(ErrorCode::InvalidArgument, "the ground's colour must lie between 0 and 1");
  return {};
}

Ground groundUnder(const PolygonMesh& head, UpAxis up) {
  const Box box = bounds(head.positions);
  const int axis = up == UpAxis::Y ? 1 : 2;
  Ground ground;
  ground.point = 0.5 * (box.lo + box.hi);
  ground.point[axis] = box.lo[axis];
  ground.normal = Vec3::Unit(axis);
  ground.color = Vec3f(0.08f, 0.08f, 0.085f);
  ground.radius = 1.5 * (box.hi[axis] - box.lo[axis]);
  return ground;
}

}  // namespace coif
