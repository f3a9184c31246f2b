// Which strands a picture draws, and with how many points: the level of detail.
#pragma once

#include <cstdint>
#include <vector>

#include "coif/base/context.h"
#include "coif/strands/strand_set.h"
#include "preview/frame_data.h"

namespace coif::preview {

/// As shaders/strand_buffer.glsl has it.
struct StrandPoint {
  Vec3f position;
  float width;
  Vec3f tangent;
  std::uint32_t seed;
  Vec3f color;
  float along;
};
static_assert(sizeof(StrandPoint) == 48);

struct StrandGeometry {
  std::vector<StrandPoint> points;
  std::vector<std::uint32_t> starts{0};  ///< S + 1: strand s has points [starts[s], starts[s + 1])
  Box box;
  std::size_t segments() const { return points.size() - (starts.size() - 1); }
  std::size_t dropped = 0;
  double widthScale = 1;
  bool colored = false;

  /// Triangle strips with restart index kNone over (point, side) pairs.
  std::vector<std::uint32_t> stripIndices() const;
};

struct DetailOptions {
  bool lod = true;
  std::size_t maxSegments = 1000000;
};

/// With lod: a prefix of the strands (they are in progressive order), so long that the mean ribbon is about a
/// pixel wide and the bound holds; widened so that their summed area stays; points dropped while the curve
/// moves by less than 0.3 pixel and no segment exceeds 32 pixels. Without: everything. A strand with a value
/// that is not finite or with fewer than two points is dropped and counted. Same result for any number of
/// threads.
StrandGeometry makeStrandGeometry(const StrandSet& strands, const View& view, const DetailOptions& detail,
                                  const Context& context);

/// Box of the finite points; empty: zero box.
Box finiteBounds(const StrandSet& strands);

}  // namespace coif::preview
