// Strands and faces that the ray tests share.
#pragma once

#include <cmath>
#include <initializer_list>

#include "coif/base/random.h"
#include "coif/light/path_tracer.h"

namespace coif::testing {

inline void addStrand(StrandSet& strands, std::initializer_list<Vec3f> points, float width) {
  strands.points.insert(strands.points.end(), points);
  strands.widths.resize(strands.points.size(), width);
  strands.offsets.push_back(strands.points.size());
}

/// `count` wavy strands of four segments, at random in the cube [−1/2, 1/2]³.
inline StrandSet cluster(std::size_t count, float width) {
  StrandSet strands;
  for (std::size_t s = 0; s < count; ++s) {
    const CounterRandom random(11, s);
    const auto u = [&](std::uint64_t i) { return float(random.uniform(i)) - 0.5f; };
    const Vec3f a(u(0), u(1), u(2)), d = Vec3f(u(3), u(4), u(5)).normalized() * 0.1f;
    const Vec3f bend = 0.03f * Vec3f(u(6), u(7), u(8));
    addStrand(strands, {a, a + d + bend, a + 2 * d, a + 3 * d - bend, a + 4 * d}, width);
  }
  return strands;
}

/// A square of side 2 `half` around the origin, its outside towards `normal`.
inline PolygonMesh square(const Vec3& normal, double half) {
  PolygonMesh mesh;
  const Vec3 n = normal.normalized(), u = half * n.unitOrthogonal(), v = n.cross(u);
  mesh.positions = {-u - v, u - v, u + v, -u + v};
  const std::uint32_t face[] = {0, 1, 2, 3};
  mesh.addFace(face);
  return mesh;
}

/// No light at all; tests turn on what they look at.
inline Lights darkness() {
  Lights lights;
  lights.key.color = lights.fill.color = lights.rim.color = Vec3f::Zero();
  lights.skyColor = lights.groundColor = Vec3f::Zero();
  lights.followCamera = false;
  return lights;
}
inline Lights uniformLight(float radiance = 1) {
  Lights lights = darkness();
  lights.skyColor = lights.groundColor = Vec3f::Constant(radiance);
  return lights;
}

/// From far away along −z: the view's height at the origin.
inline Camera farCamera(double height) {
  Camera camera;
  camera.eye = Vec3(0, 0, 50);
  camera.fovDeg = 2 * std::atan(0.5 * height / 50) * 180 / 3.14159265358979323846;
  return camera;
}

}  // namespace coif::testing
