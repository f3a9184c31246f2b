#include "coif/light/forward_scattering.h"

#include <algorithm>
#include <cmath>

namespace coif {
namespace {

constexpr std::size_t kMostValues = 6;  // forward depth of R, G, B; variance of R, G, B

bool isGrey(const DualScattering& hair) {
  const auto alike = [](const std::vector<float>& colors) {
    for (std::size_t i = 0; i < colors.size(); i += 3) {
      if (colors[i] != colors[i + 1] || colors[i] != colors[i + 2]) return false;
    }
    return true;
  };
  return alike(hair.tables().forwardAttenuation) && alike(hair.tables().forwardVariance);
}

// What a fibre that covers `alpha` does to the light that meets its texel, in so many colour channels.
std::array<float, kMostValues> valuesOf(const DualScattering& hair, std::size_t colors, const Vec3& tangent,
                                        const Vec3& toLight, double alpha) {
  const double theta = std::asin(std::clamp(tangent.dot(toLight), -1.0, 1.0));
  const Vec3 forward = hair.forwardAttenuation(theta), variance = hair.forwardVariance(theta);
  std::array<float, kMostValues> out;
  for (std::size_t c = 0; c < colors; ++c) {
    const double passed = forward[long(c)], left = std::max(1 - alpha * (1 - passed), 1e-7);
    out[c] = float(-std::log(left));
    out[c + colors] = float(alpha * passed * variance[long(c)] / left);
  }
  return out;
}

Vec3 towardsLight(const LightView& view, const Vec3& from) {
  return view.perspective ? (view.eye - from).normalized() : Vec3(-view.forward);
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
  const std::size_t colors = options.leaveOut && isGrey(hair) ? 1 : 3;
  ChannelSource source;
  source.count = int(2 * colors);
  source.fill = [&](const Fragment& fragment, std::span<float> out) {
    const Vec3 a = strands.points[fragment.point].cast<double>();
    const Vec3 d = strands.points[fragment.point + 1].cast<double>() - a;
    const Vec3 toLight = towardsLight(view, a + double(fragment.along) * d);
    const auto values = valuesOf(hair, colors, d.normalized(), toLight, double(fragment.alpha));
    std::copy_n(values.begin(), 2 * colors, out.begin());
  };
  auto map = buildVisibility(*stream, options, source, context);
  if (!map) return map.error();
  return ForwardScatteringMap(std::move(map).value(), hair);
}

// A hair's own fragments, some of them in front of the point for no other reason than that it lies aslant in
// its texels, and what a layer that both are in smears.
void ForwardScatteringMap::takeOut(const Vec3& world, const OwnHair& own,
                                   std::span<VisibilityMap::Tap> taps) const {
  constexpr double kReach = 2.5;  // texels; a query mixes what lies within one and a half
  const LightView& view = map_->view();
  const Vec3 toLight = towardsLight(view, world);
  const double depth = view.project(world).z(), texel = view.texelAt(depth);
  const double across = (own.tangent - own.tangent.dot(toLight) * toLight).norm();
  if (!(across > 1e-6) || !(texel > 0)) return;  // along the light: no fragments
  const Vec3 reach = kReach * texel / across * own.tangent;
  MapSegment segment;
  if (!segment.set(view, world - reach, world + reach)) return;
  segment.rasterize(view.size, 0, view.size, [&](int x, int y, double at, double, double stretch) {
    const std::size_t here = std::size_t(y) * std::size_t(view.size) + std::size_t(x);
    for (VisibilityMap::Tap& tap : taps) {
      if (tap.texel != here) continue;
      const double share = map_->shareInFront(here, at, depth);
      if (!(share > 0)) continue;
      const double alpha = std::min(own.coverage * stretch / view.texelAt(at), double(kGreatestAlpha));
      const std::size_t colors = colorChannels();
      const auto values = valuesOf(*hair_, colors, own.tangent, toLight, alpha);
      tap.sums[0] = std::max(0.0, tap.sums[0] - share * double(opticalDepthOf(float(alpha))));
      for (std::size_t c = 0; c < 2 * colors; ++c) {
        tap.sums[c + 1] = std::max(0.0, tap.sums[c + 1] - share * double(values[c]));
      }
    }
  });
}

ForwardScattering ForwardScatteringMap::at(const Vec3& world, const OwnHair& own) const {
  ForwardScattering out;
  const OpaqueMap* opaque = map_->options().opaque;
  if (opaque != nullptr && opaque->blocks(world)) return {0, Vec3::Zero(), Vec3::Zero()};
  std::array<VisibilityMap::Tap, 4> taps;
  const std::span found = std::span(taps).first(std::size_t(map_->tapsAt(world, taps)));
  if (own.coverage > 0) takeOut(world, own, found);
  Vec3 spread = Vec3::Zero();
  const std::size_t colors = colorChannels();
  for (const VisibilityMap::Tap& tap : found) {
    out.directFraction -= tap.weight * -std::expm1(-tap.sums[0]);
    for (std::size_t c = 0; c < colors; ++c) {
      const double lost = -std::expm1(-tap.sums[c + 1]);
      out.transmittance[long(c)] -= tap.weight * lost;
      spread[long(c)] += tap.weight * (1 - lost) * tap.sums[c + 1 + colors];
    }
  }
  if (colors == 1) {
    out.transmittance.setConstant(out.transmittance.x());
    spread.setConstant(spread.x());
  }
  out.directFraction = std::clamp(out.directFraction, 0.0, 1.0);
  for (int c = 0; c < 3; ++c) {
    out.transmittance[c] = std::clamp(out.transmittance[c], 0.0, 1.0);
    // The sum is the mean over direct light, which has none, and scattered light.
    const double scattered = out.transmittance[c] - out.directFraction;
    out.variance[c] = scattered > 1e-9 * out.transmittance[c] ? spread[c] / scattered : 0;
  }
  return out;
}

}  // namespace coif
