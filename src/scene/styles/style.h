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

/// Where a column lies of the lines that a style splits hair along; 0 where both kinds meet in it.
struct Lie {
  int side = 0;   ///< of the parting: −1 left, +1 right
  int depth = 0;  ///< of the shoulders: −1 falls behind them, +1 before
};

/// One vertex of the root layer as a style sees it.
struct Root {
  Vec3 point = Vec3::Zero();   ///< head space
  Vec3 normal = Vec3::Zero();  ///< outward, head space
  double rank = 0;             ///< 0 at the lowest root, 1 at the highest: how far out its hair lies
  Lie lie;                     ///< of the column on it that a guide is asked for
};

/// The guide of a root: one point a layer, or else any number, then evenly resampled.
using GuideMaker = std::function<Guide(const Root&)>;

/// Every root with its normal and rank; `lie` is left at 0. Indexed as the mesh's layer-0 vertices are.
std::vector<Root> rootsOf(const HairMesh& mesh, const StyleInput& input);

/// The root layer on the cage.
Result<HairMesh> rootLayer(const StyleInput& input);

/// `layers` extrusions of every bundle given.
Status extrudeLayers(HairMesh& mesh, std::span<const BundleId> bundles, std::uint32_t layers);

/// Target of every vertex: its root's guide for the vertex's own lie, resampled to the column's height.
std::vector<Vec3> targetsOf(const HairMesh& mesh, const StyleInput& input, const std::vector<Lie>& lies,
                            const GuideMaker& guide);

/// Middle of the bundle's root face, head space.
Vec3 middleOf(const HairMesh& mesh, const StyleInput& input, const Bundle& bundle);

/// Separates, from `layer` upwards, the root edges between bundles of the two kinds whose ends (head space)
/// both lie `along` the line wanted. Returns how many.
std::size_t separateBetween(HairMesh& mesh, const StyleInput& input, const BundleSide& negative,
                            std::uint32_t layer, const std::function<bool(const Vec3&)>& along);

// The styles.
Result<Hairstyle> bob(const StyleInput& input);
Result<Hairstyle> longHair(const StyleInput& input);
Result<Hairstyle> pixie(const StyleInput& input);
Result<Hairstyle> mohawk(const StyleInput& input);
Result<Hairstyle> bun(const StyleInput& input);

}  // namespace coif::styles
