// A grid of quads laid into a patch through its disc map, and smoothed on it.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "coif/base/context.h"
#include "coif/scalp/mirror.h"
#include "patch.h"

namespace coif {

struct GridSize {
  std::uint32_t columns = 0, rows = 0;
};

/// Nearest-point queries on a patch in space and in its disc.
class PatchLocator {
 public:
  PatchLocator(const Patch& patch, const DiscMap& map, const Context& context = {});
  ~PatchLocator();
  PatchPoint nearest(const Vec3& position) const;
  PatchPoint inDisc(const Vec2& uv) const;
  Vec3 position(const PatchPoint& point) const;
  const Patch& patch() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Even columns and rows near `count` quads, in the proportion of the patch's two middle lines.
GridSize chooseGrid(const PatchLocator& locator, int count);

/// (columns + 1) × (rows + 1) places, row by row from the front, each row from left to right.
/// `mirror`: vertices of the two halves are smoothed as mirror images of each other.
std::vector<PatchPoint> layGrid(const PatchLocator& locator, GridSize size, std::uint32_t front,
                                std::uint32_t back, const std::optional<MirrorPlane>& mirror, int rounds,
                                const Context& context);

/// Corners of quad (i, j), wound outward.
inline std::array<std::uint32_t, 4> gridQuad(GridSize size, std::uint32_t i, std::uint32_t j) {
  const std::uint32_t a = j * (size.columns + 1) + i, c = a + size.columns + 1;
  return {a, c, c + 1, a + 1};
}

}  // namespace coif
