// Hair in wisps: three guide chains each, and strands that go along with them.
//
// A wisp is a neighbourhood of strands, three of which are its guides (Bertails et al. 2005); only guides are
// simulated. Each point of a guide carries its link's frame. A strand's point follows the mean of the rigid
// motions of its three guides at the same fraction of their spline: it is where it was modelled as long as
// the guides are, and turns with them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "coif/base/context.h"
#include "coif/base/result.h"
#include "coif/hairmesh/hair_mesh.h"
#include "coif/scalp/surface.h"
#include "coif/strands/strand_set.h"

namespace coif {

struct WispOptions {
  std::size_t wisps = 100;    ///< wanted, 1 … 10 000; fewer where there are not so many strands
  std::uint32_t points = 12;  ///< a guide, 2 … 256
  std::uint64_t seed = 1;     ///< of the roots
};

/// G guides of `points` points each, row after row, at rest; a guide may serve its wisp more than once.
struct WispSet {
  struct Root {
    std::vector<std::uint32_t> vertices;  ///< corners of its root face
    std::vector<double> weights;          ///< mean value coordinates, Σ = 1
  };

  std::uint32_t points = 0;
  std::vector<Vec3> guides;                         ///< G × points, root first
  std::vector<Root> roots;                          ///< G
  std::vector<std::array<std::uint32_t, 3>> wisps;  ///< W

  std::size_t guideCount() const { return roots.size(); }
  std::span<const Vec3> guide(std::size_t g) const { return std::span(guides).subspan(g * points, points); }
};

/// Guides are strands of the placed mesh, with roots of their own: another number of strands does not change
/// them. Wisps gather what is near along its whole length, so that a parting parts them; guides are the three
/// that stand furthest apart. Errors: those of grow(), InvalidArgument for options out of range.
/// O(wisps²).
Result<WispSet> makeWisps(const HairMesh& mesh, const WispOptions& options, const Surface* head = nullptr,
                          const Context& context = {});

/// Whom a strand follows.
struct WispStrand {
  std::uint32_t wisp = 0;
  std::array<double, 3> weights{};  ///< of its root in the triangle of the guides' roots, >= 0, Σ = 1
};
/// The nearest wisp along the whole length. O(strands · wisps), in parallel.
std::vector<WispStrand> bindStrands(const WispSet& wisps, const StrandSet& strands,
                                    const Context& context = {});

/// Moves `strands` from rest to where the guides' points (G × points) are; `headTurn` turns what has no link:
/// the roots. Point j of P is at the fraction j/(P − 1). Errors: InvalidArgument for sizes that do not fit or
/// strands with different numbers of points. Same bytes for any number of threads.
Status carryStrands(const WispSet& wisps, std::span<const Vec3> positions, const Mat3& headTurn,
                    std::span<const WispStrand> bound, StrandSet& strands, const Context& context = {});

}  // namespace coif
