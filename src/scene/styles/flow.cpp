#include "scene/styles/flow.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace coif::styles {

namespace {

/// Horizontal direction away from the parting line (u = 0, w >= whorl), turning backwards towards its end so
/// that the two sides meet the hair behind in one sweep: a fan about the end alone would spread so wide that
/// strands between its columns cut through the head. `side` decides on the line itself.
Vec3 awayFromParting(const Vec3& point, double whorl, int side) {
  constexpr double kTurning = 0.45;   // head heights before the parting's end
  constexpr double kBackwards = 2.5;  // per unit sideways, at and behind the end
  if (point.z() < whorl)
    return Vec3(point.x(), 0, point.z() - whorl - kBackwards * std::abs(point.x())).normalized();
  if (side == 0) return Vec3(0, 0, -1);
  const double before = std::min(1.0, (point.z() - whorl) / kTurning);
  const double angle = std::atan(kBackwards) * std::cos(0.5 * M_PI * before);
  return Vec3(side * std::cos(angle), 0, -std::sin(angle));
}

/// The last vertex of the parting: the cage has none just where the style wants the end.
double partingEnd(const HairMesh& mesh, const StyleInput& input, const std::vector<int>& sides,
                  double wanted) {
  double end = 1e300;
  for (std::uint32_t v = 0; v < sides.size(); ++v) {
    const double depth = input.space.fromScene(mesh.position(v)).z();
    if (mesh.vertices()[v].layer == 0 && sides[v] == 0 && depth >= wanted) end = std::min(end, depth);
  }
  return end;
}

/// How far back the ridge of the shoulders lies: the highest that hair hanging beside the neck meets above
/// `bottom`. None where a head ends above.
std::optional<double> shoulderRidge(const StyleInput& input, double bottom) {
  constexpr double kBeside = 0.40, kFrom = -0.35, kReach = 0.7, kStep = 0.02;
  std::optional<double> ridge;
  double highest = bottom;
  for (double depth = -kReach; depth <= kReach; depth += kStep) {
    double height = 0;
    for (const double side : {-kBeside, kBeside}) {
      SurfacePoint hit;
      const bool met = input.head.intersect(input.space.toScene({side, kFrom, depth}),
                                            input.space.directionToScene({0, -1, 0}), input.head.size(), hit);
      height += 0.5 * (met ? input.space.fromScene(hit.position).y() : 2 * bottom);
    }
    if (height > highest) highest = height, ridge = depth;
  }
  return ridge;
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

CombOptions combing(const FlowStyle& style, std::optional<double> ridge, const Root& root) {
  const double front = smoothStep(0.05, 0.35, root.point.z());
  CombOptions out;
  out.length = style.length;
  out.rise = 0.12;
  out.direction = [=, lie = root.lie](const Vec3& point, double s) {
    const double fade = std::exp(-s / style.reach);
    Vec3 wanted = Vec3(0, -1, 0) + style.fan * fade * awayFromParting(point, style.whorl, lie.side) +
                  style.back * front * fade * Vec3(0, 0, -1);
    if (ridge && lie.depth != 0) {
      // Over the shoulders hair falls in front or behind, not along them.
      constexpr double kBefore = 0.35, kBehind = 0.25, kSoft = 0.15;
      const double low = smoothStep(-0.20, -0.40, point.y());
      const double lane = *ridge + (lie.depth > 0 ? kBefore : -kBehind);
      const double pull = std::clamp(lie.depth * (lane - point.z()) / kSoft, 0.0, 1.0);
      wanted += style.shoulders * low * pull * Vec3(-0.5 * point.x(), 0, lie.depth);
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
  if (root.lie.side == 0) {
    out.constrain = [x = root.point.x()](const Vec3& point) { return Vec3(x, point.y(), point.z()); };
  } else {
    out.constrain = keepOffFace;
  }
  return out;
}

}  // namespace

Result<Hairstyle> flow(const StyleInput& input, FlowStyle style) {
  COIF_ASSIGN(HairMesh mesh, rootLayer(input));
  std::vector<BundleId> all;
  for (const Bundle& bundle : mesh.bundles()) all.push_back(bundle.id);
  COIF_TRY(extrudeLayers(mesh, all, style.layers));
  const BundleSide left = [&](const Bundle& bundle) { return middleOf(mesh, input, bundle).x() < 0; };
  const BundleSide behind = [&](const Bundle& bundle) {
    return middleOf(mesh, input, bundle).z() < style.divide;
  };
  const auto parting = [&](const Vec3& end) { return end.z() >= style.whorl; };
  if (style.parted && separateBetween(mesh, input, left, 1, parting) == 0) {
    return makeError(ErrorCode::Degenerate,
                     "no edges of the cage run between the left and the right of the head to part "
                     "the hair on; choose a region on both sides");
  }
  std::optional<double> ridge;
  if (style.shoulders > 0) ridge = shoulderRidge(input, style.lowest);
  // Columns before and behind the shoulders may not share bundles: strands between them would run through.
  if (ridge) separateBetween(mesh, input, behind, style.layers / 3, [](const Vec3&) { return true; });
  const auto sides = sidesOf(mesh, left), depths = sidesOf(mesh, behind);
  if (style.parted) style.whorl = partingEnd(mesh, input, sides, style.whorl);
  std::vector<Lie> lies(sides.size());
  for (std::size_t v = 0; v < lies.size(); ++v) lies[v] = {sides[v], ridge ? depths[v] : 0};
  const auto targets = targetsOf(mesh, input, lies, [&](const Root& root) {
    return comb(input.head, input.space, root.point, root.normal, combing(style, ridge, root));
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
  style.lowest = -1.0;
  style.cut = [lowest = style.lowest](const Vec3&) { return lowest; };
  return flow(input, style);
}

}  // namespace coif::styles
