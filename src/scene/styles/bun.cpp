#include <cmath>

#include "scene/styles/style.h"

namespace coif::styles {

namespace {

/// The knot: hair gathers in a ring at the back of the head and is wound around a ball behind it.
struct Knot {
  Vec3 tie = Vec3(0, 0.30, -0.52);                // head space, moved onto the head
  Vec3 axis = Vec3(0, 0.42, -0.91).normalized();  // out of the head
  double ring = 0.075;                            // radius of the gathered hair
  double ball = 0.155;                            // radius of the bun
  double turns = 0.7;                             // of the winding
};

Guide towardsTie(const StyleInput& input, const Root& root, const Vec3& port) {
  CombOptions options;
  options.length = 2;
  options.rise = 0.1;
  options.turn = 0.35;
  options.direction = [=](const Vec3& point, double) { return Vec3(port - point); };
  const double cover = 0.008 + 0.018 * root.rank;
  options.clearance = [=](double s) { return cover * smoothStep(0, 0.1, s); };
  options.stop = [=](const Vec3& point, double) { return (point - port).norm() < 0.03; };
  Guide guide = comb(input.head, input.space, root.point, root.normal, options);
  guide.push_back(port);
  return guide;
}

/// From the ring over the ball: out along its far side while turning about the axis.
void wind(Guide& guide, const Knot& knot, double angle, double depth) {
  const Vec3 right = knot.axis.cross(Vec3(0, 1, 0)).normalized(), up = right.cross(knot.axis);
  const Vec3 centre = knot.tie + knot.axis * (knot.ball * 0.72);
  const double start = M_PI - std::asin(knot.ring / knot.ball);
  for (int i = 1; i <= 48; ++i) {
    const double s = i / 48.0;
    const double polar = start + (0.06 * M_PI - start) * s;
    const double turn = angle + 2 * M_PI * knot.turns * s;
    const double radius = knot.ball * (1 - 0.5 * depth * std::sin(polar));
    guide.push_back(centre + radius * (std::sin(polar) * (std::cos(turn) * right + std::sin(turn) * up) +
                                       std::cos(polar) * knot.axis));
  }
}

}  // namespace

/// All hair combed back into a knot.
Result<Hairstyle> bun(const StyleInput& input) {
  COIF_ASSIGN(HairMesh mesh, rootLayer(input));
  std::vector<BundleId> all;
  for (const Bundle& bundle : mesh.bundles()) all.push_back(bundle.id);
  constexpr std::uint32_t kScalpLayers = 5, kKnotLayers = 8;
  COIF_TRY(extrudeLayers(mesh, all, kScalpLayers + kKnotLayers));
  Knot knot;
  knot.tie =
      input.space.fromScene(input.head.nearest(input.space.toScene(knot.tie)).position) + 0.012 * knot.axis;
  const Vec3 right = knot.axis.cross(Vec3(0, 1, 0)).normalized(), up = right.cross(knot.axis);
  const auto guide = [&](const Root& root) {
    // Where on the ring it arrives: from its own side of the head, near roots inside, far ones outside.
    const Vec3 offset = root.point - knot.tie;
    const double angle = std::atan2(offset.dot(up), offset.dot(right));
    const double far = std::min(1.0, offset.norm() / 0.9);
    const double radius = knot.ring * std::sqrt(std::max(0.02, far));
    const Vec3 port = knot.tie + radius * (std::cos(angle) * right + std::sin(angle) * up);
    Guide scalpPart = resample(towardsTie(input, root, port), kScalpLayers + 1);
    Guide knotPart{port};
    wind(knotPart, knot, angle, 1 - far);
    knotPart = resample(knotPart, kKnotLayers + 1);
    // One point a layer already: evenly spaced within each part, not over the whole.
    scalpPart.insert(scalpPart.end(), knotPart.begin() + 1, knotPart.end());
    return scalpPart;
  };
  const auto targets = targetsOf(mesh, input, std::vector<Lie>(mesh.vertices().size()), guide);
  SettleOptions options;
  options.tolerance = 0.012;
  COIF_ASSIGN(const HairstyleReport report,
              settle(mesh, targets, input.head, input.space, options, input.context));
  return Hairstyle{std::move(mesh), report, 115};
}

}  // namespace coif::styles
