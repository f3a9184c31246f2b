#include "scene/styles/flow.h"

#include <algorithm>
#include <cmath>

namespace coif::styles {

namespace {

/// Horizontal direction away from the parting line (u = 0, w >= whorl), turning backwards towards its end so
/// that the two sides meet the hair behind in one sweep. `side` decides on the line itself.
Vec3 awayFromParting(const Vec3& point, double whorl, int side) {
  constexpr double kTurning = 0.22;  // head heights before the parting's end
  Vec3 away(point.x(), 0, std::min(0.0, point.z() - whorl));
  if (point.z() >= whorl) {
    if (side == 0) return Vec3(0, 0, -1);
    away = Vec3(side, 0, -1.6 * smoothStep(whorl + kTurning, whorl, point.z()));
  } else {
    away.z() -= 0.25 * std::abs(point.x()) + 0.02;
  }
  return away.normalized();
}

/// Keeps hair beside the face: in front of the ears and below the forehead it may not come closer to the
/// middle.
Vec3 keepOffFace(const Vec3& point) {
  constexpr double kFront = 0.12, kForehead = 0.32, kHalfWidth = 0.28;
  const double depth =
      smoothStep(kFront, kFront + 0.12, point.z()) * smoothStep(kForehead, kForehead - 0.16, point.y());
  const double least = kHalfWidth * depth;
  if (std::abs(point.x()) >= least) return point;
  return Vec3(std::copysign(least, point.x()), point.y(), point.z());
}

CombOptions combing(const FlowStyle& style, const Root& root) {
  const double front = smoothStep(0.05, 0.35, root.point.z());
  const bool ahead = root.point.z() > style.divide;
  CombOptions out;
  out.length = style.length;
  out.rise = 0.12;
  out.direction = [=, side = root.side](const Vec3& point, double s) {
    const double fade = std::exp(-s / style.reach);
    Vec3 wanted = Vec3(0, -1, 0) + style.fan * fade * awayFromParting(point, style.whorl, side) +
                  style.back * front * fade * Vec3(0, 0, -1);
    if (style.shoulders > 0) {
      // Over the shoulders hair falls in front or behind, not along them.
      const double low = smoothStep(-0.25, -0.45, point.y()) * smoothStep(-0.80, -0.65, point.y());
      wanted += style.shoulders * low * Vec3(-0.5 * point.x(), 0, ahead ? 0.45 : -0.8);
    }
    if (style.tuck > 0 && style.cut) {
      const double near = smoothStep(style.tuckSpan, 0, point.y() - style.cut(point));
      wanted += style.tuck * near * Vec3(-point.x(), 0, -point.z() - 0.1).normalized();
    }
    return wanted;
  };
  // Hair lies thicker the more roots it has passed: close at the root, farther out down the head.
  const double over = style.thickness * std::pow(root.rank, 1.3);
  out.clearance = [=](double s) {
    return style.close * smoothStep(0, 0.14, s) + over * smoothStep(0.05, style.ramp, s) +
           0.003 * smoothStep(0, 0.02, s);
  };
  if (style.cut)
    out.stop = [cut = style.cut](const Vec3& point, double s) { return s > 0.06 && point.y() <= cut(point); };
  // Hair of the middle stays there: going round the head it would drift to either side by rounding alone.
  if (root.side == 0) {
    out.constrain = [x = root.point.x()](const Vec3& point) { return Vec3(x, point.y(), point.z()); };
  } else {
    out.constrain = keepOffFace;
  }
  return out;
}

}  // namespace

Result<Hairstyle> flow(const StyleInput& input, const FlowStyle& style) {
  COIF_ASSIGN(HairMesh mesh, rootLayer(input));
  std::vector<BundleId> all;
  for (const Bundle& bundle : mesh.bundles()) all.push_back(bundle.id);
  COIF_TRY(extrudeLayers(mesh, all, style.layers));
  if (style.parted && separateParting(mesh, input, style.whorl) == 0) {
    return makeError(ErrorCode::Degenerate,
                     "no edges of the cage run between the left and the right of the head to part "
                     "the hair on; choose a region on both sides");
  }
  const auto sides =
      sidesOf(mesh, [&](std::uint32_t bundle) { return onLeft(mesh, input, mesh.bundles()[bundle]); });
  const auto targets = targetsOf(mesh, input, sides, [&](const Root& root) {
    return comb(input.head, input.space, root.point, root.normal, combing(style, root));
  });
  COIF_ASSIGN(const HairstyleReport report,
              settle(mesh, targets, input.head, input.space, {}, input.context));
  return Hairstyle{std::move(mesh), report};
}

Result<Hairstyle> bob(const StyleInput& input) {
  FlowStyle style;
  style.cut = [](const Vec3& point) { return -0.40 - 0.16 * point.z(); };
  style.tuck = 0.7;
  return flow(input, style);
}

Result<Hairstyle> longHair(const StyleInput& input) {
  FlowStyle style;
  style.layers = 9;
  style.length = 2.6;
  style.back = 0.8;
  style.thickness = 0.045;
  style.shoulders = 0.8;
  style.cut = [](const Vec3&) { return -1.0; };
  return flow(input, style);
}

}  // namespace coif::styles
