// The container of strands: the same bytes go to NumPy, the GPU and the files.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "coif/base/result.h"
#include "coif/base/vec.h"
#include "coif/scalp/polygon_mesh.h"

namespace coif {

/// S strands, P points in all; strand s has points [offsets[s], offsets[s+1]), root first. Positions in scene
/// units, float. Arrays marked optional are empty or of the stated length.
struct StrandSet {
  std::vector<std::uint64_t> offsets{0};     ///< S + 1
  std::vector<Vec3f> points;                 ///< P, row-major xyz, no padding
  std::vector<float> widths;                 ///< P diameters, optional
  std::vector<std::uint64_t> ids;            ///< S stable ids, optional
  std::vector<std::uint32_t> rootFaces;      ///< S bundle ids (BundleId), optional
  std::vector<std::uint64_t> weightOffsets;  ///< S + 1 into weights, optional
  std::vector<float> weights;                ///< mean value coordinates of the root in its face, optional
  std::vector<Vec2f> rootUvs;                ///< S, optional
  std::vector<std::uint32_t> groups;         ///< S indices into groupNames, optional
  std::vector<std::uint8_t> guides;          ///< S flags, 1 = guide, optional
  std::vector<Vec3f> colors;                 ///< P linear RGB, optional
  std::vector<float> transparencies;         ///< P, 0 opaque, optional
  std::vector<std::string> groupNames;
  double metersPerUnit = 0.01;
  UpAxis upAxis = UpAxis::Y;
  std::string information;         ///< free text that some formats carry (.hair: 87 bytes at most)
  std::vector<std::string> notes;  ///< what a reader left out or had to assume, a sentence each

  std::size_t strandCount() const { return offsets.size() - 1; }
  std::size_t pointCount() const { return points.size(); }
  std::span<const Vec3f> strand(std::size_t s) const {
    return std::span(points).subspan(offsets[s], offsets[s + 1] - offsets[s]);
  }
  std::uint64_t bytes() const;  ///< of all arrays
};
static_assert(sizeof(Vec3f) == 12 && sizeof(Vec2f) == 8, "the arrays are handed out without padding");

/// Refuses offsets that do not ascend or do not end at P, arrays of the wrong length, group indices out of
/// range; with `requireFinite`, points or widths that are not finite. Names the strand.
Status validate(const StrandSet& strands, bool requireFinite = true);

/// Diameter at a point: the stored one, or that of a human hair (0.08 mm) where the set has none.
float widthAt(const StrandSet& strands, std::size_t point);
/// Whether light and preview can show a strand: two points or more, positions and colours finite, widths
/// finite and not negative. `strands` keeps what validate(…, false) asks.
bool drawable(const StrandSet& strands, std::size_t s);

}  // namespace coif
