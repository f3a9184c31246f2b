// Guide curves by combing: a curve marches over the head, follows a direction field, and keeps its distance.
#pragma once

#include <functional>
#include <vector>

#include "coif/scalp/surface.h"

namespace coif::styles {

/// Coordinates of a head: origin at its middle, lengths in head heights (chin to crown = 1).
struct HeadSpace {
  Vec3 origin = Vec3::Zero();  ///< between the ears, half way from chin to crown
  Mat3 axes =
      Mat3::Identity();  ///< columns: right (the viewer's, facing the face: the head's left), up, forward
  double height = 1;     ///< scene units a head height

  Vec3 fromScene(const Vec3& p) const { return axes.transpose() * (p - origin) / height; }
  Vec3 toScene(const Vec3& p) const { return origin + height * (axes * p); }
  Vec3 directionFromScene(const Vec3& d) const { return axes.transpose() * d; }
  Vec3 directionToScene(const Vec3& d) const { return axes * d; }
};

/// A polyline in head space.
using Guide = std::vector<Vec3>;

struct CombOptions {
  double length = 1;    ///< head heights
  double step = 0.015;  ///< head heights
  double turn = 0.35;   ///< share of the wanted direction taken up each step: low is stiff
  double rise = 0.25;   ///< how far the first direction leans from the comb towards the scalp normal
  /// Wanted direction at a point after arc length s; need not be unit.
  std::function<Vec3(const Vec3& point, double s)> direction;
  /// Least distance to the head after arc length s.
  std::function<double(double s)> clearance;
  /// True where the curve has reached its end (a cut line); may be empty.
  std::function<bool(const Vec3& point, double s)> stop;
  /// A last word on the position, such as keeping off the face; may be empty.
  std::function<Vec3(const Vec3& point)> constrain;
};

/// Combs from `root` (head space, on the head) whose outward normal is `normal`.
Guide comb(const Surface& head, const HeadSpace& space, const Vec3& root, const Vec3& normal,
           const CombOptions& options);

/// `count` points evenly spaced by arc length, ends included.
Guide resample(const Guide& guide, std::size_t count);

/// Distance to the head in head heights, negative inside, and the direction away from it.
double clearanceOf(const Surface& head, const HeadSpace& space, const Vec3& point, Vec3& away);

/// Smooth step from 0 at `a` to 1 at `b`.
double smoothStep(double a, double b, double x);

}  // namespace coif::styles
