// What styling adds to strands of a hair mesh, and how it is laid on: by whoever holds the strands, here or
// on a GPU. Room `style` finds it (style_plan.h has the formula).
#pragma once

#include <span>
#include <vector>

#include "coif/hairmesh/hair_mesh.h"
#include "coif/strands/strand_curve.h"

namespace coif {

/// Of S strands with P points in all; all empty where nothing is styled. The first offset of every strand is
/// zero: hair stays on the head.
struct StrandStyle {
  std::span<const std::uint64_t> strandOffsets;  ///< S + 1, of the strands' points
  std::span<const Vec3f> offsets;                ///< P: along normal, binormal, tangent
  std::span<const float> reach;                  ///< S, > 0: end of the strand / end of its curve
  std::span<const float> widths;                 ///< P factors; empty: widths stay
  std::span<const float> rootTurns;  ///< S: angle from the root face's frame, turned to the strand's first
                                     ///< tangent, to its first normal

  bool empty() const { return offsets.empty(); }
};

/// Of the first step that is one; zero where there is none.
Vec3 firstTangent(std::span<const Vec3f> points);
/// One frame a bundle: of its root face.
std::vector<Frame> rootFaceFrames(const HairMesh& mesh);
/// The frame that a strand starts with: its face's, turned to its first tangent and then about it.
Frame rootFrame(const Frame& face, std::span<const Vec3f> points, float turn);

/// The point of a styled strand: `offset` in the curve's frame at a place of StrandCurve's (a point's number
/// times the strand's reach).
Vec3 styledPoint(const StrandCurve& curve, double place, const Vec3& offset);

}  // namespace coif
