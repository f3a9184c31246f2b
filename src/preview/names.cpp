#include "coif/preview/names.h"

#include <algorithm>

namespace coif {
namespace {

constexpr const char* kShadings[] = {"studio", "kajiya-kay", "marschner", "energy-conserving",
                                     "dual-scattering"};
constexpr PreviewShading kShadingOf[] = {PreviewShading::Studio, PreviewShading::KajiyaKay,
                                         PreviewShading::Marschner, PreviewShading::Marschner,
                                         PreviewShading::DualScattering};

constexpr const char* kVisibilities[] = {
    "none", "opacity", "density-clustering", "light-map", "deep-opacity", "occupancy", "exact"};
constexpr VisibilityMethod kVisibilityOf[] = {
    VisibilityMethod::None,     VisibilityMethod::Opacity,     VisibilityMethod::DensityClustering,
    VisibilityMethod::LightMap, VisibilityMethod::DeepOpacity, VisibilityMethod::Occupancy,
    VisibilityMethod::Exact};

constexpr const char* kTransparencies[] = {"auto",
                                           "opaque",
                                           "stochastic",
                                           "alpha-to-coverage",
                                           "weighted-average",
                                           "occupancy-ordered",
                                           "depth-layers",
                                           "half-angle-slices",
                                           "exact-lists"};
constexpr PreviewTransparency kTransparencyOf[] = {PreviewTransparency::Auto,
                                                   PreviewTransparency::Opaque,
                                                   PreviewTransparency::Stochastic,
                                                   PreviewTransparency::AlphaToCoverage,
                                                   PreviewTransparency::WeightedAverage,
                                                   PreviewTransparency::OccupancyOrdered,
                                                   PreviewTransparency::DepthLayers,
                                                   PreviewTransparency::HalfAngleSlices,
                                                   PreviewTransparency::ExactLists};

static_assert(std::size(kShadings) == std::size(kShadingOf));
static_assert(std::size(kVisibilities) == std::size(kVisibilityOf));
static_assert(std::size(kTransparencies) == std::size(kTransparencyOf));

template <class Value>
Status choose(std::span<const char* const> words, std::span<const Value> values, std::string_view word,
              const char* what, Value& out) {
  const auto at = std::ranges::find(words, word, [](const char* w) { return std::string_view(w); });
  if (at != words.end()) {
    out = values[std::size_t(at - words.begin())];
    return {};
  }
  std::string all;
  for (const char* each : words) all += (all.empty() ? "" : ", ") + std::string(each);
  return makeError(ErrorCode::InvalidArgument,
                   std::string(what) + " is one of " + all + ", not '" + std::string(word) + "'");
}

}  // namespace

std::span<const char* const> shadingNames() {
  return kShadings;
}
std::span<const char* const> visibilityNames() {
  return kVisibilities;
}
std::span<const char* const> transparencyNames() {
  return kTransparencies;
}

Status setShading(PreviewOptions& options, std::string_view word) {
  COIF_TRY(choose<PreviewShading>(kShadings, kShadingOf, word, "shading", options.shading));
  if (word == "marschner") options.fibre.model = FibreModel::Marschner;
  if (word == "energy-conserving") options.fibre.model = FibreModel::Chiang;
  return {};
}

Status setVisibility(PreviewOptions& options, std::string_view word) {
  return choose<VisibilityMethod>(kVisibilities, kVisibilityOf, word, "visibility",
                                  options.visibility.method);
}

Status setTransparency(PreviewOptions& options, std::string_view word) {
  return choose<PreviewTransparency>(kTransparencies, kTransparencyOf, word, "transparency",
                                     options.transparency);
}

}  // namespace coif
