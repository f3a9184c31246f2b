// The endless sequence of root places of one face.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coif/hairmesh/hair_mesh.h"
#include "coif/strands/root_face.h"

namespace coif {

/// A toroidal progressive blue-noise sequence on the unit square, the same in every process.
std::span<const Vec2f> progressiveTile();

/// The tile laid on the face's plane, turned and shifted by a hash of (seed, bundle), its points outside the
/// face skipped. Indices count all points of the tile, inside or not, so a small change of the face renames
/// no root that stays inside.
class RootSequence {
 public:
  RootSequence(const RootFace& face, std::uint64_t seed, BundleId bundle);

  struct Root {
    std::uint32_t index;
    Vec2 place;  ///< in the face's plane
  };
  Root next();

 private:
  Vec2 tilePoint(std::uint64_t index) const;

  const RootFace& face_;
  std::span<const Vec2f> tile_;
  Vec2 shift_;
  unsigned symmetry_;  ///< of the square: bit 0 swaps the axes, bits 1 and 2 mirror them
  double side_;        ///< of the tile on the face
  bool sliver_;        ///< too thin to be hit: area-preserving map instead
  std::uint64_t next_ = 0;
};

}  // namespace coif
