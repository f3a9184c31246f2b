#include "scene/styles/comb.h"

#include <algorithm>
#include <cmath>

namespace coif::styles {

double smoothStep(double a, double b, double x) {
  const double t = std::clamp((x - a) / (b - a), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

double clearanceOf(const Surface& head, const HeadSpace& space, const Vec3& point, Vec3& away) {
  const Vec3 scene = space.toScene(point);
  const SurfacePoint foot = head.nearest(scene);
  const bool inside = head.windingNumber(scene) > 0.5;
  const Vec3 offset = inside ? Vec3(foot.position - scene) : Vec3(scene - foot.position);
  // Close to the surface the difference is rounding noise: the surface's own normal is the better direction.
  const Vec3 direction = foot.distance > 1e-4 * space.height ? Vec3(offset / foot.distance) : foot.normal;
  away = space.directionFromScene(direction).normalized();
  return (inside ? -foot.distance : foot.distance) / space.height;
}

Guide comb(const Surface& head, const HeadSpace& space, const Vec3& root, const Vec3& normal,
           const CombOptions& options) {
  Guide guide{root};
  Vec3 point = root;
  Vec3 heading = options.direction(root, 0).normalized();
  heading -= std::min(0.0, heading.dot(normal)) * normal;
  heading = (heading.normalized() + options.rise * normal).normalized();
  for (double s = 0; s < options.length;) {
    const double step = std::min(options.step, options.length - s);
    Vec3 away;
    double distance = clearanceOf(head, space, point, away);
    Vec3 wanted = options.direction(point, s).normalized();
    const double least = options.clearance(s);
    if (distance < least + 2 * step) wanted -= std::min(0.0, wanted.dot(away)) * away;
    heading += options.turn * (wanted - heading);
    if (heading.norm() < 1e-6) heading = away;
    heading.normalize();
    point += step * heading;
    s += step;
    distance = clearanceOf(head, space, point, away);
    const double nowLeast = options.clearance(s);
    if (distance < nowLeast) point += (nowLeast - distance) * away;
    if (options.constrain) point = options.constrain(point);
    heading = (0.5 * heading + 0.5 * (point - guide.back()).normalized()).normalized();
    guide.push_back(point);
    if (options.stop && options.stop(point, s)) break;
  }
  return guide;
}

Guide resample(const Guide& guide, std::size_t count) {
  std::vector<double> length(guide.size(), 0);
  for (std::size_t i = 1; i < guide.size(); ++i) length[i] = length[i - 1] + (guide[i] - guide[i - 1]).norm();
  Guide out(count);
  std::size_t segment = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double target = length.back() * double(i) / double(count - 1);
    while (segment + 2 < guide.size() && length[segment + 1] < target) ++segment;
    const double span = length[segment + 1] - length[segment];
    const double t = span > 0 ? std::clamp((target - length[segment]) / span, 0.0, 1.0) : 0;
    out[i] = guide[segment] + t * (guide[segment + 1] - guide[segment]);
  }
  out.front() = guide.front();
  return out;
}

}  // namespace coif::styles
