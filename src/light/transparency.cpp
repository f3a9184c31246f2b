#include "coif/light/transparency.h"

#include <algorithm>

#include "coif/light/visibility.h"

namespace coif {
namespace {

struct Part {
  float depth, alpha;
  Vec3f color;
};

/// Sums of one pixel's fragments.
struct PixelSum {
  Vec3 color = Vec3::Zero();
  double weight = 0, beta = 0, count = 0;
  void add(const Vec3f& c, double w, double b) {
    color += w * c.cast<double>();
    weight += w, beta += b, ++count;
  }
};

HairPixels emptyPicture(const FragmentStream& stream) {
  return {stream.view().size, std::vector<Vec3f>(stream.texelCount(), Vec3f::Zero()),
          std::vector<float>(stream.texelCount(), 0.0f)};
}

void composeSorted(std::vector<Part>& parts, Vec3f& color, float& alpha) {
  std::stable_sort(parts.begin(), parts.end(),
                   [](const Part& a, const Part& b) { return a.depth < b.depth; });
  Vec3 sum = Vec3::Zero();
  double through = 1;
  for (const Part& p : parts) {
    sum += through * double(p.alpha) * p.color.cast<double>();
    through *= 1 - double(p.alpha);
  }
  color = sum.cast<float>();
  alpha = float(1 - through);
}

using ColorOf = std::function<Vec3f(const Fragment&)>;

// By bands, so that the lists of the whole picture are never there at once.
HairPixels blendSorted(const FragmentStream& stream, const ColorOf& colorOf, const Context& context) {
  HairPixels picture = emptyPicture(stream);
  const std::size_t bandTexels = std::size_t(FragmentStream::kBandRows) * std::size_t(picture.size);
  parallelFor(context, std::size_t(stream.bandCount()), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t band = begin; band < end; ++band) {
      const std::size_t first = band * bandTexels;
      std::vector<std::vector<Part>> lists(std::min(bandTexels, picture.alpha.size() - first));
      stream.forBand(int(band), [&](const Fragment& f) {
        lists[f.texel - first].push_back({f.depth, f.alpha, colorOf(f)});
      });
      for (std::size_t i = 0; i < lists.size(); ++i) {
        composeSorted(lists[i], picture.color[first + i], picture.alpha[first + i]);
      }
    }
  });
  return picture;
}

HairPixels blendAverage(const FragmentStream& stream, const ColorOf& colorOf, const Context& context) {
  std::vector<PixelSum> sums(stream.texelCount());
  stream.forEach(context, [&](const Fragment& f) { sums[f.texel].add(colorOf(f), double(f.alpha), 0); });
  HairPixels picture = emptyPicture(stream);
  for (std::size_t t = 0; t < sums.size(); ++t) {
    const PixelSum& s = sums[t];
    if (!(s.weight > 0)) continue;
    const double alpha = -std::expm1(s.count * std::log1p(-s.weight / s.count));
    picture.color[t] = (alpha / s.weight * s.color).cast<float>();
    picture.alpha[t] = float(alpha);
  }
  return picture;
}

double normalised(OrderNormalisation rule, double lambda, double sum) {
  switch (rule) {
    case OrderNormalisation::None:
      return 1;
    case OrderNormalisation::Corrected:
      return lambda / sum;
    case OrderNormalisation::AsPrinted:
      return sum / lambda;
  }
  return 1;
}

Result<HairPixels> blendOrdered(const FragmentStream& stream, const ColorOf& colorOf,
                                const TransparencyOptions& options, const Context& context) {
  VisibilityOptions occupancy;
  occupancy.method = VisibilityMethod::Occupancy;
  occupancy.occupancySlices = options.occupancySlices;
  occupancy.slabs = options.slabs;
  COIF_ASSIGN(const auto order, buildVisibility(stream, occupancy, {}, context));
  std::vector<PixelSum> sums(stream.texelCount());
  stream.forEach(context, [&](const Fragment& f) {
    const double through = std::exp(-order->opticalDepthAt(f.texel, double(f.depth)));
    sums[f.texel].add(colorOf(f), double(f.alpha) * through, double(f.beta()));
  });
  HairPixels picture = emptyPicture(stream);
  for (std::size_t t = 0; t < sums.size(); ++t) {
    const PixelSum& s = sums[t];
    if (!(s.weight > 0)) continue;
    const double lambda = -std::expm1(-s.beta);
    picture.color[t] = (normalised(options.normalisation, lambda, s.weight) * s.color).cast<float>();
    picture.alpha[t] = float(lambda);
  }
  return picture;
}

}  // namespace

Result<HairPixels> blendHair(const FragmentStream& stream, const ColorOf& color,
                             const TransparencyOptions& options, const Context& context) {
  if (!color) return makeError(ErrorCode::InvalidArgument, "blending hair needs the fragments' colours");
  const auto blend = [&]() -> Result<HairPixels> {
    switch (options.method) {
      case TransparencyMethod::OccupancyOrdered:
        return blendOrdered(stream, color, options, context);
      case TransparencyMethod::WeightedAverage:
        return blendAverage(stream, color, context);
      default:
        return blendSorted(stream, color, context);
    }
  };
  Result<HairPixels> picture = blend();
  if (context.cancelled()) return makeError(ErrorCode::Cancelled, "blending the hair was cancelled");
  return picture;
}

}  // namespace coif
