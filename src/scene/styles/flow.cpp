#include "scene/styles/flow.h"

#include <algorithm>
#include <cmath>

namespace coif::styles {

namespace {

/// Horizontal direction away from the parting line (u = 0, w >= whorl); `side` decides on the line itself.
Vec3 awayFromParting(const Vec3& point, double whorl, int side) {
  const Vec3 foot(0, 0, std::max(point.z(), whorl));
  Vec3 away(point.x() - foot.x(), 0, point.z() - foot.z());
  if (point.z() >= whorl && side != 0) away = Vec3(side, 0, 0);
  return away.norm() > 1e-6 ? Vec3(away.normalized()) : Vec3(0, 0, -1);
}

/// Keeps hair beside the face: in front of the ears and below the forehead it may not come closer to the middle.
Vec3 keepOffFace(const Vec3& point) {
  constexpr double kFront = 0.10, kForehead = 0.30, kHalfWidth = 0.33;
  const double depth = smoothStep(kFront, kFront + 0.12, point.z()) * smoothStep(kForehead, kForehead - 0.18, point.y());
  const double least = kHalfWidth * depth;
  if (std::abs(point.x()) >= least) return point;
  return Vec3(std::copysign(least, point.x()), point.y(), point.z());
}

CombOptions combing(const FlowStyle& style, const Root& root) {
  const double front = smoothStep(0.05, 0.35, root.point.z());
  CombOptions out;
  out.length = style.length;
  out.direction = [=, side = root.side](const Vec3& point, double s) {
    const double fade = std::exp(-s / style.reach);
    Vec3 wanted = Vec3(0, -1, 0) + style.fan * fade * awayFromParting(point, style.whorl, side) +
                  style.back * front * fade * Vec3(0, 0, -1);
    if (style.tuck > 0 && style.cut) {
      const double near = smoothStep(style.tuckSpan, 0, point.y() - style.cut(point));
      wanted += style.tuck * near * Vec3(-point.x(), 0, -point.z() - 0.1).normalized();
    }
    return wanted;
  };
  const double cover = style.close + style.thickness * std::pow(root.rank, 1.3);
  out.clearance = [=](double s) { return cover * smoothStep(0, 0.16, s) + 0.004 * smoothStep(0, 0.02, s); };
  if (style.cut) out.stop = [cut = style.cut](const Vec3& point, double s) { return s > 0.06 && point.y() <= cut(point); };
  out.constrain = keepOffFace;
  return out;
}

}  // namespace

Result<Hairstyle> flow(const StyleInput& input, const FlowStyle& style) {
  COIF_ASSIGN(HairMesh mesh, rootLayer(input));
  std::vector<BundleId> all;
  for (const Bundle& bundle : mesh.bundles()) all.push_back(bundle.id);
  COIF_TRY(extrudeLayers(mesh, all, style.layers));
  if (style.parted) {
    COIF_ASSIGN(const std::size_t edges, separateParting(mesh, input, style.whorl));
    if (edges == 0) {
      return makeError(ErrorCode::Degenerate, "the cage has no line of vertices along the middle to part the hair on");
    }
  }
  const auto sides = sidesOf(mesh, [&](std::uint32_t bundle) {
    double sum = 0;
    for (std::uint32_t v : mesh.bundles()[bundle].face(0)) sum += input.space.fromScene(mesh.position(v)).x();
    return sum < 0;
  });
  const auto targets =
      targetsOf(mesh, input, sides, [&](const Root& root) { return comb(input.head, input.space, root.point, root.normal, combing(style, root)); });
  COIF_ASSIGN(const HairstyleReport report, settle(mesh, targets, input.head, input.space, {}, input.context));
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
  style.back = 1.0;
  style.thickness = 0.085;
  style.cut = [](const Vec3& point) { return -1.05 + 0.10 * point.z(); };
  return flow(input, style);
}

}  // namespace coif::styles
