#include <cmath>

#include "scene/styles/flow.h"

namespace coif::styles {

/// Short, combed forward and down from the whorl, longest on top; no parting.
Result<Hairstyle> pixie(const StyleInput& input) {
  COIF_ASSIGN(HairMesh mesh, rootLayer(input));
  std::vector<BundleId> all;
  for (const Bundle& bundle : mesh.bundles()) all.push_back(bundle.id);
  COIF_TRY(extrudeLayers(mesh, all, 5));
  const auto guide = [&](const Root& root) {
    const double top = smoothStep(0.15, 0.45, root.point.y());
    CombOptions options;
    options.length = 0.11 + 0.13 * top;
    options.rise = 0.45;
    options.turn = 0.5;
    options.direction = [&, root](const Vec3& point, double) {
      const Vec3 whorl(0.04, 0.5, -0.22);
      Vec3 radial = point - whorl;
      radial.y() = 0;
      // The fringe is swept to one side, off the eyes.
      const double fringe = smoothStep(0.1, 0.4, root.point.z());
      return Vec3(radial.normalized() + Vec3(0.75 * fringe, -0.9 - 0.6 * (1 - top), 0.25 * (1 - fringe)));
    };
    options.clearance = [=](double s) {
      return (0.010 + 0.026 * top) * smoothStep(0, 0.10, s) + 0.004 * smoothStep(0, 0.02, s);
    };
    options.stop = [=](const Vec3& point, double s) {
      return s > 0.05 && point.z() > 0.2 && point.y() < 0.17;
    };
    return comb(input.head, input.space, root.point, root.normal, options);
  };
  const auto targets = targetsOf(mesh, input, std::vector<Lie>(mesh.vertices().size()), guide);
  COIF_ASSIGN(const HairstyleReport report,
              settle(mesh, targets, input.head, input.space, {}, input.context));
  return Hairstyle{std::move(mesh), report};
}

}  // namespace coif::styles
