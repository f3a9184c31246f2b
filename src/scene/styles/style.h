// What every hairstyle starts from, and the steps they share.
#pragma once

#include <functional>
#include <vector>

#include "scene/styles/comb.h"
#include "scene/styles/settle.h"

namespace coif::styles {

struct StyleInput {
  const Cage& cage;
  const Surface& head;
  HeadSpace space;
  Context context;
};

/// One vertex of the root layer as a style sees it.
struct Root {
  Vec3 point = Vec3::Zero();   ///< head space
  Vec3 normal = Vec3::Zero();  ///< outward, head space
  double rank = 0;             ///< 0 at the lowest root, 1 at the highest: how far out its hair lies
  int side = 1;                ///< of the parting, −1 or +1; 0 where both sides meet
};

/// The guide of a root: one point a layer, or else any number, then evenly resampled.
using GuideMaker = std::function<Guide(const Root&)>;

/// Every root with its normal and rank; `side` is left at 1. Indexed as the mesh's layer-0 vertices are.
std::vector<Root> rootsOf(const HairMesh& mesh, const StyleInput& input);

/// The root layer on the cage.
Result<HairMesh> rootLayer(const StyleInput& input);

/// `layers` extrusions of every bundle given.
Status extrudeLayers(HairMesh& mesh, std::span<const BundleId> bundles, std::uint32_t layers);

/// Target of every vertex: its root's guide (on its side of the parting), resampled to the column's height.
std::vector<Vec3> targetsOf(const HairMesh& mesh, const StyleInput& input, const std::vector<int>& sides,
                            const GuideMaker& guide);

/// Does the bundle's root face lie on the side of negative u?
bool onLeft(const HairMesh& mesh, const StyleInput& input, const Bundle& bundle);

/// Separates, from layer 1 upwards, the root edges between left and right bundles from the front back to
/// depth `back` (head space w). Returns how many.
std::size_t separateParting(HairMesh& mesh, const StyleInput& input, double back);

// The styles.
Result<Hairstyle> bob(const StyleInput& input);
Result<Hairstyle> longHair(const StyleInput& input);
Result<Hairstyle> pixie(const StyleInput& input);
Result<Hairstyle> mohawk(const StyleInput& input);
Result<Hairstyle> bun(const StyleInput& input);

}  // namespace coif::styles
