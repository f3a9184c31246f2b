#include <algorithm>
#include <cmath>

#include "scene/styles/style.h"

namespace coif::styles {

namespace {

constexpr double kHalfStrip = 0.115;  // of the standing strip at the root, head heights

/// In the strip: the cage's middle four columns, or by the middle of the face where the cage is no grid.
bool inStrip(const HairMesh& mesh, const StyleInput& input, const Bundle& bundle) {
  double middle = 0, column = 0;
  for (std::uint32_t v : bundle.face(0)) {
    middle += input.space.fromScene(mesh.position(v)).x() / bundle.corners;
    if (!input.cage.grid.empty()) column += double(input.cage.grid[v][0]) / bundle.corners;
  }
  if (input.cage.grid.empty()) return std::abs(middle) < kHalfStrip;
  return std::abs(column - input.cage.columns / 2) < 2;
}

/// The fan: straight up at the root, leaning back a little, thinning to a crest.
Guide crest(const Root& root) {
  const double along =
      std::clamp((root.point.z() + 0.45) / 0.9, 0.0, 1.0);  // 0 at the nape, 1 at the forehead
  const double height = 0.16 + 0.24 * std::sin(M_PI * (0.15 + 0.75 * along));
  Vec3 up = root.normal;
  up.x() = 0;
  up = (up.normalized() + Vec3(0, 0.35, 0)).normalized();
  Guide guide;
  for (int i = 0; i <= 24; ++i) {
    const double s = i / 24.0;
    Vec3 p = root.point + s * height * up + 0.05 * s * s * Vec3(0, 0, -1);
    p.x() = root.point.x() * (1 - 0.72 * smoothStep(0, 1, s));
    guide.push_back(p);
  }
  return guide;
}

/// The shaved sides: stubble that leans down and back.
Guide stubble(const Root& root) {
  const Vec3 lean = (root.normal + 0.6 * Vec3(0, -0.7, -0.7)).normalized();
  return {root.point, root.point + 0.012 * lean};
}

}  // namespace

/// A standing strip over shaved sides.
Result<Hairstyle> mohawk(const StyleInput& input) {
  COIF_ASSIGN(HairMesh mesh, rootLayer(input));
  std::vector<BundleId> strip, sides;
  for (const Bundle& bundle : mesh.bundles()) {
    (inStrip(mesh, input, bundle) ? strip : sides).push_back(bundle.id);
  }
  if (strip.empty())
    return makeError(ErrorCode::Degenerate, "the cage has no quads along the middle of the head");
  COIF_TRY(extrudeLayers(mesh, strip, 5));
  if (!sides.empty()) COIF_TRY(extrudeLayers(mesh, sides, 1));
  // A root on the strip's border stands and lies at once: its columns are told apart by their height.
  std::vector<Lie> kinds(mesh.vertices().size());
  for (const Bundle& bundle : mesh.bundles()) {
    for (std::uint32_t v : bundle.vertices) kinds[v].side = bundle.height() > 1 ? 1 : kinds[v].side;
  }
  const auto targets = targetsOf(
      mesh, input, kinds, [](const Root& root) { return root.lie.side == 1 ? crest(root) : stubble(root); });
  COIF_ASSIGN(const HairstyleReport report,
              settle(mesh, targets, input.head, input.space, {}, input.context));
  return Hairstyle{std::move(mesh), report};
}

}  // namespace coif::styles
