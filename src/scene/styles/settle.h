// From guide curves to a hair mesh: outer vertices follow them, inner ones are placed and pinned only where
// needed.
#pragma once

#include <functional>
#include <vector>

#include "coif/base/context.h"
#include "coif/scene/hairstyle.h"
#include "scene/styles/comb.h"

namespace coif::styles {

/// Where every vertex ought to be, in scene units: targets[v] for vertex index v.
struct SettleOptions {
  double tolerance = 0.015;  ///< an inner vertex may end this far from its target, in head heights
  double clearance = 0.010;  ///< and must stay this far outside the head
};

/// Pushes the targets out of the head, sets all vertices above the root to them, places the inner ones, and
/// pins the worst of those that came out too far from their target or too close to the head, until none is
/// left.
Result<HairstyleReport> settle(HairMesh& mesh, std::vector<Vec3> targets, const Surface& head,
                               const HeadSpace& space, const SettleOptions& options, const Context& context);

/// The root vertex (index) below each vertex.
std::vector<std::uint32_t> rootAncestors(const HairMesh& mesh);

/// Which of two kinds a bundle is of: true is the negative one.
using BundleSide = std::function<bool(const Bundle&)>;

/// The kind of each vertex's bundles: −1, +1, or 0 where bundles of both meet in it.
std::vector<int> sidesOf(const HairMesh& mesh, const BundleSide& negative);

}  // namespace coif::styles
