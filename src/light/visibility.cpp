#include "coif/light/visibility.h"

#include <numeric>

#include "light/map_passes.h"

namespace coif {
namespace {

constexpr double kMostBytes = 8.0 * (1 << 30);

class NoShadows : public VisibilityMap {
 public:
  NoShadows(const LightView& view, const VisibilityOptions& options, int channels)
      : VisibilityMap(view, options, channels) {}
  double bytesPerTexel() const override { return 0; }

 protected:
  void sumsAt(std::size_t, double, std::span<double> out) const override { std::ranges::fill(out, 0.0); }
};

bool within(int value, int lo, int hi) {
  return value >= lo && value <= hi;
}

Status check(const FragmentStream& stream, const VisibilityOptions& options, const ChannelSource& channels) {
  const char* wrong = nullptr;
  if (!within(options.slices, 1, 4096)) wrong = "an opacity map has 1 … 4096 slices";
  if (!within(options.clusters, 1, 16)) wrong = "density clustering has 1 … 16 clusters";
  if (!within(options.layers, 0, 255)) wrong = "a deep opacity map has 1 … 255 layers, or 0 to choose them";
  if (!(options.bound > 0)) wrong = "the bound for choosing layers has to be positive";
  if (!(options.layerSize >= 0 && std::isfinite(options.layerSize)))
    wrong = "a layer's size has to be positive";
  if (!within(options.slabs, 1, 32) || !within(options.occupancySlices, 32, 1024) ||
      options.occupancySlices % (32 * options.slabs) != 0) {
    wrong = "occupancy slices have to fill whole words of 32 in each of 1 … 32 slabs";
  }
  if (!within(options.gridLog2Size, 3, 9)) wrong = "a light map has 8 … 512 cells a side";
  if (!within(channels.count, 0, ChannelSource::kMost) || (channels.count > 0 && !channels.fill)) {
    wrong = "a map sums at most 15 further channels, each with a source";
  }
  if (options.opaque != nullptr && options.opaque->view().size != stream.view().size) {
    wrong = "the opaque map has another size than the hair's";
  }
  return wrong != nullptr ? Status(makeError(ErrorCode::InvalidArgument, wrong)) : Status();
}

}  // namespace

const char* name(VisibilityMethod method) {
  switch (method) {
    case VisibilityMethod::None:
      return "none";
    case VisibilityMethod::Opacity:
      return "opacity";
    case VisibilityMethod::DensityClustering:
      return "density-clustering";
    case VisibilityMethod::LightMap:
      return "light-map";
    case VisibilityMethod::DeepOpacity:
      return "deep-opacity";
    case VisibilityMethod::Occupancy:
      return "occupancy";
    case VisibilityMethod::Exact:
      return "exact";
  }
  return "unknown";
}

Status checkMapBytes(double bytes) {
  if (bytes <= kMostBytes) return {};
  return makeError(ErrorCode::TooLarge, "the shadow map would exceed 8 GiB");
}

MapResult buildNone(const FragmentStream& stream, const VisibilityOptions& options,
                    const ChannelSource& channels, const Context&) {
  return MapResult(std::make_unique<NoShadows>(stream.view(), options, 1 + channels.count));
}

DepthRange depthRange(const FragmentStream& stream, const Context& context) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  DepthRange range{std::vector<float>(stream.texelCount(), kInfinity),
                   std::vector<float>(stream.texelCount(), -kInfinity), 0};
  std::vector<std::uint64_t> counts(std::size_t(stream.bandCount()), 0);
  const std::size_t bandTexels = std::size_t(FragmentStream::kBandRows) * std::size_t(stream.view().size);
  stream.forEach(context, [&](const Fragment& f) {
    ++counts[f.texel / bandTexels];
    range.near[f.texel] = std::min(range.near[f.texel], f.depth);
    range.far[f.texel] = std::max(range.far[f.texel], f.depth);
  });
  range.fragments = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
  return range;
}

std::array<double, 2> DepthRange::whole() const {
  float lo = std::numeric_limits<float>::infinity(), hi = -lo;
  for (std::size_t t = 0; t < near.size(); ++t) lo = std::min(lo, near[t]), hi = std::max(hi, far[t]);
  if (!(lo <= hi)) return {0, 1};
  return {double(lo), double(hi)};
}

double DepthRange::greatestExtent() const {
  float extent = 0;
  for (std::size_t t = 0; t < near.size(); ++t) extent = std::max(extent, empty(t) ? 0 : far[t] - near[t]);
  return double(extent);
}

// call(texel, weight) for what a query mixes; weights of taps off the map are left out, which means lit.
template <class Call>
void VisibilityMap::taps(const Vec3& p, Call&& call) const {
  const int size = view_.size;
  if (!p.allFinite() || (view_.perspective && !(p.z() > 0))) return;
  const auto inside = [&](double x, double y) { return x >= 0 && x < size && y >= 0 && y < size; };
  const auto texelOf = [&](double x, double y) {
    return std::size_t(y) * std::size_t(size) + std::size_t(x);
  };
  if (!options_.filter) {
    if (inside(p.x(), p.y())) call(texelOf(p.x(), p.y()), 1.0);
    return;
  }
  if (!inside(p.x() + 1, p.y() + 1) && !inside(p.x() - 1, p.y() - 1)) return;
  const double x0 = std::floor(p.x() - 0.5), y0 = std::floor(p.y() - 0.5);
  const double fx = p.x() - 0.5 - x0, fy = p.y() - 0.5 - y0;
  for (int c = 0; c < 4; ++c) {
    const double weight = (c & 1 ? fx : 1 - fx) * (c & 2 ? fy : 1 - fy);
    const double x = x0 + (c & 1), y = y0 + (c >> 1);
    if (weight > 0 && inside(x, y)) call(texelOf(x, y), weight);
  }
}

double VisibilityMap::transmittance(const Vec3& world) const {
  if (options_.opaque != nullptr && options_.opaque->blocks(world)) return 0;
  double result = 1;
  if (ownTransmittance(world, result)) return result;
  const Vec3 p = view_.project(world);
  std::array<double, 1 + ChannelSource::kMost> out;
  taps(p, [&](std::size_t texel, double weight) {
    sumsAt(texel, p.z(), std::span(out).first(std::size_t(channels_)));
    result -= weight * -std::expm1(-out[0]);
  });
  return std::clamp(result, 0.0, 1.0);
}

double VisibilityMap::opticalDepth(const Vec3& world) const {
  double own = 1;
  if (ownTransmittance(world, own)) return -std::log(std::max(own, 1e-300));
  const Vec3 p = view_.project(world);
  const bool inFront = p.allFinite() && (!view_.perspective || p.z() > 0);
  if (!inFront || !(p.x() >= 0 && p.x() < view_.size && p.y() >= 0 && p.y() < view_.size)) return 0;
  return opticalDepthAt(std::size_t(p.y()) * std::size_t(view_.size) + std::size_t(p.x()), p.z());
}

double VisibilityMap::opticalDepthAt(std::size_t texel, double depth) const {
  if (texel >= std::size_t(view_.size) * std::size_t(view_.size)) return 0;
  std::array<double, 1 + ChannelSource::kMost> out;
  sumsAt(texel, depth, std::span(out).first(std::size_t(channels_)));
  return out[0];
}

void VisibilityMap::sums(const Vec3& world, std::span<float> result) const {
  std::array<double, 1 + ChannelSource::kMost> out, mixed{};
  const Vec3 p = view_.project(world);
  double own = 1;
  if (ownTransmittance(world, own)) {
    mixed[0] = -std::log(std::max(own, 1e-300));
  } else {
    taps(p, [&](std::size_t texel, double weight) {
      sumsAt(texel, p.z(), std::span(out).first(std::size_t(channels_)));
      for (int c = 0; c < channels_; ++c) mixed[std::size_t(c)] += weight * out[std::size_t(c)];
    });
  }
  for (std::size_t c = 0; c < std::min(result.size(), std::size_t(channels_)); ++c)
    result[c] = float(mixed[c]);
}

int VisibilityMap::tapsAt(const Vec3& world, std::array<Tap, 4>& out) const {
  const Vec3 p = view_.project(world);
  double own = 1;
  int count = 0;
  if (ownTransmittance(world, own)) return 0;
  taps(p, [&](std::size_t texel, double weight) {
    Tap& tap = out[std::size_t(count++)];
    tap.texel = texel;
    tap.weight = weight;
    sumsAt(texel, p.z(), std::span(tap.sums).first(std::size_t(channels_)));
  });
  return count;
}

double VisibilityMap::shareInFront(std::size_t, double fragmentDepth, double depth) const {
  return fragmentDepth < depth ? 1 : 0;
}

double VisibilityMap::boundAt(const Vec3& world) const {
  const Vec3 p = view_.project(world);
  double bound = 0;
  taps(p, [&](std::size_t texel, double weight) {
    const Interval interval = intervalAt(texel, p.z());
    bound += weight * (std::exp(-interval.from) - std::exp(-interval.to));
  });
  return bound;
}

MapResult buildVisibility(const FragmentStream& stream, const VisibilityOptions& options,
                          const ChannelSource& channels, const Context& context) {
  COIF_TRY(check(stream, options, channels));
  const auto build = [&]() -> MapResult {
    switch (options.method) {
      case VisibilityMethod::Opacity:
        return buildOpacity(stream, options, channels, context);
      case VisibilityMethod::DensityClustering:
        return buildClustering(stream, options, channels, context);
      case VisibilityMethod::DeepOpacity:
        return buildDeepOpacity(stream, options, channels, context);
      case VisibilityMethod::LightMap:
        return buildGrid(stream, options, channels, context);
      case VisibilityMethod::Occupancy:
        return buildOccupancy(stream, options, channels, context);
      case VisibilityMethod::Exact:
        return buildExact(stream, options, channels, context);
      default:
        return buildNone(stream, options, channels, context);
    }
  };
  MapResult map = build();
  if (context.cancelled()) return makeError(ErrorCode::Cancelled, "the shadow map was cancelled");
  return map;
}

}  // namespace coif
