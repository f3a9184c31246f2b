// Where strands start: a progressive blue-noise sequence of roots over the root layer.
//
// Every root face has a sequence of its own, keyed by (seed, BundleId) and laid in the face's plane from its
// first side. The sequences are merged by density: root n of bundle b comes at (n + offset_b)/(weight_b ·
// area_b). So
// - every prefix is blue noise by weight, and level of detail is a prefix;
// - another count or density takes more or fewer of the same roots; none moves or changes its id;
// - an edit elsewhere on the mesh changes nothing in this face but how many of its roots are taken.
// The sequence of a face is a toroidal best-candidate sequence (Mitchell 1991) of 8192 points; a face that
// takes more goes through it again, shifted, and is blue noise down to the spacing of the first pass.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coif/base/context.h"
#include "coif/base/result.h"
#include "coif/hairmesh/hair_mesh.h"

namespace coif {

/// The bundle in the high 32 bits, the place in its face's own sequence in the low.
constexpr std::uint64_t strandId(BundleId bundle, std::uint32_t index) {
  return (std::uint64_t(bundle) << 32) | index;
}
constexpr BundleId bundleOf(std::uint64_t strandId) {
  return BundleId(std::uint32_t(strandId >> 32));
}

/// R roots in progressive order. Root r lies in bundle bundles[r] (an index) with mean value coordinates
/// weights[weightOffsets[r] …], one a corner.
struct RootSet {
  std::vector<std::uint64_t> ids;            ///< R
  std::vector<std::uint32_t> bundles;        ///< R
  std::vector<std::uint64_t> weightOffsets;  ///< R + 1
  std::vector<float> weights;
  std::vector<std::uint32_t>
      byBundle;  ///< R: the roots of bundle b are byBundle[bundleStarts[b] …], in order
  std::vector<std::uint64_t> bundleStarts;  ///< bundle count + 1
  std::size_t negativeWeights = 0;          ///< roots with a negative coordinate (concave faces)
  std::size_t triangulatedFaces = 0;        ///< root faces that cross themselves in their plane
  std::size_t barrenBundles = 0;            ///< no area, or height 0
  std::size_t zeroLength = 0;               ///< roots that bundles of no length would have had

  std::size_t size() const { return ids.size(); }
  std::span<const float> weightsOf(std::size_t root) const {
    return std::span(weights).subspan(weightOffsets[root], weightOffsets[root + 1] - weightOffsets[root]);
  }
};

struct RootOptions {
  std::size_t count = 10000;  ///< exactly so many, <= 2^31, while any bundle can carry one
  std::uint64_t seed = 1;
  std::span<const double> density = {};  ///< weight a bundle (by index), >= 0; empty: all 1
};

/// Roots over the bundles of height >= 1. A bundle is of no length when no corner column is longer than 1e-9
/// of the mesh's box. Errors: InvalidArgument (density of the wrong length, negative or not finite),
/// Degenerate (no bundle can carry a root while count > 0), TooLarge, Cancelled. Same bytes for any number of
/// threads. Cost: linear, about 0.3 µs a root on one thread.
Result<RootSet> placeRoots(const HairMesh& mesh, const RootOptions& options, const Context& context = {});

}  // namespace coif
