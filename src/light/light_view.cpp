#include "coif/light/light_view.h"

#include <algorithm>
#include <cmath>

namespace coif {
namespace {

void orient(LightView& view, const Vec3& forward) {
  const double length = forward.norm();
  view.forward = length > 0 && std::isfinite(length) ? Vec3(forward / length) : Vec3(-Vec3::UnitY());
  view.right = view.forward.unitOrthogonal();
  view.up = view.right.cross(view.forward);
}

double usableDiagonal(const Box& box) {
  const double diagonal = box.diagonal();
  return std::isfinite(diagonal) && diagonal > 0 ? diagonal : 1.0;
}

}  // namespace

Vec3 LightView::project(const Vec3& world) const {
  const Vec3 d = world - eye;
  const double depth = d.dot(forward);
  const double scale = perspective ? 1 / (texel * std::max(depth, 1e-300)) : 1 / texel;
  return Vec3(0.5 * size + d.dot(right) * scale, 0.5 * size + d.dot(up) * scale, depth);
}

LightView distantLightView(const Vec3& toLight, const Box& box, int size) {
  LightView view;
  view.size = std::max(size, 1);
  orient(view, -toLight);
  // The bounding sphere with one texel of margin on every side: turning the light never rescales the map.
  const double radius = 0.5 * usableDiagonal(box) * (1 + 1e-6);
  view.texel = 2 * radius / std::max(view.size - 2, 1);
  view.eye = 0.5 * (box.lo + box.hi) - radius * view.forward;
  view.depthRange = 2 * radius;
  return view;
}

LightView pointLightView(const Vec3& position, const Box& box, int size) {
  constexpr double kWidestSlope = 3.7320508075688776;  // tan 75°
  LightView view;
  view.size = std::max(size, 1);
  view.perspective = true;
  view.eye = position;
  const Vec3 towards = 0.5 * (box.lo + box.hi) - position;
  const double radius = 0.5 * usableDiagonal(box) * (1 + 1e-6), distance = towards.norm();
  orient(view, distance > 0 ? towards : Vec3(-Vec3::UnitY()));
  const double slope =
      distance > radius ? radius / std::sqrt(distance * distance - radius * radius) : kWidestSlope;
  view.texel = 2 * std::min(slope, kWidestSlope) / std::max(view.size - 2, 1);
  view.depthRange = distance + radius;
  return view;
}

}  // namespace coif
