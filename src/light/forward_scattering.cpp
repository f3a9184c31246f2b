#include "coif/light/forward_scattering.h"

#include <algorithm>
#include <cmath>

namespace coif {
namespace {

constexpr int kChannels = 6;  // forward depth of R, G, B; variance of R, G, B

// What one fibre does to the light that meets its texel.
void addFragment(const StrandSet& strands, const DualScattering& hair, const LightView& view,
                 const Fragment& fragment, std::span<float> out) {
  const Vec3 a = strands.points[fragment.point].cast<double>();
  const Vec3 b = strands.points[fragment.point + 1].cast<double>();
  const Vec3 at = a + double(fragment.along) * (b - a);
  const Vec3 toLight = view.perspective ? (view.eye - at).normalized() : Vec3(-view.forward);
  const double theta = std::asin(std::clamp((b - a).normalized().dot(toLight), -1.0, 1.0));
  const Vec3 forward = hair.forwardAttenuation(theta), variance = hair.forwardVariance(theta);
  const double alpha = fragment.alpha;
  for (int c = 0; c < 3; ++c) {
    const double left = 1 - alpha * (1 - forward[c]);
    out[std::size_t(c)] = float(-std::log(std::max(left, 1e-7)));
    out[std::size_t(c) + 3] = float(alpha * forward[c] * variance[c] / std::max(left, 1e-7));
  }
}

}  // namespace

Result<ForwardScatteringMap> ForwardScatteringMap::build(const StrandSet& strands, const DualScattering& hair,
                                                         const LightView& view,
                                                         const VisibilityOptions& options,
                                                         const Context& context,
                                                         const FragmentOptions& fragments) {
  FragmentOptions seen = fragments;
  seen.opaque = options.opaque;
  auto stream = FragmentStream::make(strands, view, seen, context);
  if (!stream) return stream.error();
  ChannelSource source;
  source.count = kChannels;
  source.fill = [&](const Fragment& fragment, std::span<float> out) {
    addFragment(strands, hair, view, fragment, out);
  };
  auto map = buildVisibility(*stream, options, source, context);
  if (!map) return map.error();
  return ForwardScatteringMap(std::move(map).value());
}

ForwardScattering ForwardScatteringMap::at(const Vec3& world) const {
  std::array<float, kChannels + 1> sums{};
  map_->sums(world, sums);
  ForwardScattering out;
  const double unblocked = std::exp(-double(sums[0]));
  out.directFraction = map_->transmittance(world);
  // What an opaque body in the way leaves of both.
  const double open = sums[0] < 30
                          ? std::min(1.0, out.directFraction / unblocked)
                          : (map_->options().opaque == nullptr || out.directFraction > 0 ? 1.0 : 0.0);
  for (int c = 0; c < 3; ++c) {
    const double all = std::exp(-double(sums[std::size_t(c) + 1]));
    out.transmittance[c] = open * all;
    const double scattered = all - unblocked;
    // The sum is the mean over direct light, which has none, and scattered light.
    out.variance[c] = scattered > 1e-9 * all ? sums[std::size_t(c) + 4] * all / scattered : 0;
  }
  return out;
}

}  // namespace coif
