// Dual scattering's global part from a map of the light instead of rays: seven sums a place along the light
// (optical depth, and per channel the depth of forward scattering and its variance).
//
// Any visibility method that sums channels holds them: `Opacity` with many slices is the paper's voxel grid
// along the light (forward scattering map), DeepOpacity its layers on the GPU, Exact the limit.
// A fibre that covers α of a texel lets 1 − α of the light pass and scatters α ā_f forwards, independently of
// the others: direct = Π (1 − α), T_f = Π (1 − α + α ā_f); their logarithms and the variances add up.
// Filtered look-ups mix what passes, not its logarithms. A hair does not shadow itself: its own fragments are
// taken out.
#pragma once

#include <memory>
#include <span>

#include "coif/light/dual_scattering.h"
#include "coif/light/visibility.h"

namespace coif {

/// A hair at a point of it, as if it went on straight for two texels.
struct OwnHair {
  Vec3 tangent = Vec3::Zero();  ///< unit; zero: no hair
  double coverage = 0;          ///< width × opacity, scene units
};

class ForwardScatteringMap {
 public:
  /// Of one light, distant or a point, for hair of one colour. `strands` need not outlive it; `hair` and an
  /// opaque map in `options` must. Errors: those of FragmentStream::make and buildVisibility. Cost: that of
  /// the visibility method with six further channels, two for grey hair.
  static Result<ForwardScatteringMap> build(const StrandSet& strands, const DualScattering& hair,
                                            const LightView& view, const VisibilityOptions& options,
                                            const Context& context = {},
                                            const FragmentOptions& fragments = {});

  /// Never NaN; points off the map are lit. Thread-safe. `own`: the hair that the point is on, whose
  /// fragments do not count.
  ForwardScattering at(const Vec3& world, const OwnHair& own = {}) const;
  const VisibilityMap& map() const { return *map_; }
  /// 3; 1 of grey hair, whose channels are alike (VisibilityOptions::leaveOut).
  std::size_t colorChannels() const { return std::size_t(map_->channels() - 1) / 2; }

 private:
  ForwardScatteringMap(std::unique_ptr<VisibilityMap> map, const DualScattering& hair)
      : map_(std::move(map)), hair_(&hair) {}
  void takeOut(const Vec3& world, const OwnHair& own, std::span<VisibilityMap::Tap> taps) const;

  std::unique_ptr<VisibilityMap> map_;
  const DualScattering* hair_;
};

}  // namespace coif
