// What the shadow maps' passes share.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <vector>

#include "coif/light/visibility.h"

namespace coif {

/// Depths of the first and last fragment of every texel; +∞ and −∞ where there is none.
struct DepthRange {
  std::vector<float> near, far;
  std::uint64_t fragments = 0;  ///< of all texels
  bool empty(std::size_t texel) const { return !(near[texel] <= far[texel]); }
  /// Over all texels; a unit range when there is no fragment.
  std::array<double, 2> whole() const;
  double greatestExtent() const;  ///< far − near of a texel, 0 when there is none
};
DepthRange depthRange(const FragmentStream& stream, const Context& context);

/// β and the further values of one fragment.
class FragmentValues {
 public:
  explicit FragmentValues(const ChannelSource& source) : source_(&source) {}
  int count() const { return 1 + source_->count; }
  std::array<float, 1 + ChannelSource::kMost> operator()(const Fragment& fragment) const {
    std::array<float, 1 + ChannelSource::kMost> values;
    values[0] = fragment.beta();
    if (source_->count > 0) {
      source_->fill(fragment, std::span(values).subspan(1, std::size_t(source_->count)));
    }
    return values;
  }

 private:
  const ChannelSource* source_;
};

/// Of the sorted lists of so many fragments.
inline double exactMapBytes(double texels, double fragments, int channels) {
  return 8 * (texels + 1) + fragments * 4 * (1 + channels);
}

/// Fails when `bytes` is more than a map may hold.
Status checkMapBytes(double bytes);

using MapResult = Result<std::unique_ptr<VisibilityMap>>;
MapResult buildNone(const FragmentStream&, const VisibilityOptions&, const ChannelSource&, const Context&);
MapResult buildOpacity(const FragmentStream&, const VisibilityOptions&, const ChannelSource&, const Context&);
MapResult buildClustering(const FragmentStream&, const VisibilityOptions&, const ChannelSource&,
                          const Context&);
MapResult buildDeepOpacity(const FragmentStream&, const VisibilityOptions&, const ChannelSource&,
                           const Context&);
MapResult buildGrid(const FragmentStream&, const VisibilityOptions&, const ChannelSource&, const Context&);
MapResult buildOccupancy(const FragmentStream&, const VisibilityOptions&, const ChannelSource&,
                         const Context&);
MapResult buildExact(const FragmentStream&, const VisibilityOptions&, const ChannelSource&, const Context&);

}  // namespace coif
