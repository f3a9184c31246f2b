// How many layers: the whole map decides, as light's buildDeepOpacity does.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "preview/hair_map.h"

namespace coif::preview {
namespace {

constexpr int kChoices[] = {3, 7, 11, 15};
constexpr double kInVain = 1.03;  // as on the CPU: more layers that gain less are not taken

std::string numberText(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

}  // namespace

TransmittanceBound HairMap::bound(const Programs& programs) const {
  if (options_.method == VisibilityMethod::Exact) return {0, 0};
  if (options_.method != VisibilityMethod::DeepOpacity) return {};
  const GLuint groups = GLuint(view_.size + 7) / 8;
  std::vector<Vec4f> sums(std::size_t(groups) * groups, Vec4f::Zero());
  const Buffer out = makeBuffer(std::span<const Vec4f>(sums));
  bind();
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 6, out.name());
  glUseProgram(programs[ProgramId::MapBound]);
  dispatchSquare(view_.size);
  read(out, 0, sums.data(), sums.size() * sizeof(Vec4f));
  double weighted = 0, weight = 0, worst = 0;
  for (const Vec4f& sum : sums) {
    weighted += double(sum.x());
    weight += double(sum.y());
    worst = std::max(worst, double(sum.z()));
  }
  return {weight > 0 ? weighted / weight : 0, worst};
}

Result<HairMap> HairMap::makeFewest(const Programs& programs, const StrandBuffers& lines,
                                    const LightView& view, double opacity, const VisibilityOptions& options,
                                    bool lists, const std::function<double(int)>& layerSize) {
  HairMap map;
  map.view_ = view;
  map.options_ = options;
  map.options_.method = VisibilityMethod::Exact;
  map.placeUniforms(opacity);
  if (lists) {
    COIF_ASSIGN(const bool drawn, map.drawShortLists(programs, lines));
    if (drawn) return map;
  }
  map.options_.method = VisibilityMethod::DeepOpacity;
  struct Candidate {
    int layers;
    double size, bound;
  };
  std::vector<Candidate> tried;
  const auto draw = [&](int layers, double size) {
    map.options_.layers = layers;
    map.options_.layerSize = size;
    map.placeUniforms(opacity);
    return map.draw(programs, lines);
  };
  for (const int layers : kChoices) {
    const double size = options.layerSize > 0 ? options.layerSize : layerSize(layers);
    map.bytes_ = 0;
    COIF_TRY(draw(layers, size));
    tried.push_back({layers, size, map.bound(programs).mean});
    if (tried.back().bound <= options.bound) break;
  }
  const double least = std::ranges::min_element(tried, {}, &Candidate::bound)->bound;
  const double aim = std::max(options.bound, kInVain * least);
  const Candidate chosen = *std::ranges::find_if(tried, [&](const Candidate& c) { return c.bound <= aim; });
  if (chosen.layers != map.options_.layers) {
    map.bytes_ = 0;
    COIF_TRY(draw(chosen.layers, chosen.size));
  }
  map.choice_ = std::to_string(chosen.layers) + " layers: bound " + numberText(chosen.bound);
  for (const Candidate& c : tried) {
    if (c.layers != chosen.layers)
      map.choice_ += ", with " + std::to_string(c.layers) + " " + numberText(c.bound);
  }
  return map;
}

// Lists that need no more memory than the smallest layered map would: exact for nothing.
Result<bool> HairMap::drawShortLists(const Programs& programs, const StrandBuffers& lines) {
  constexpr std::size_t kBytesOfThreeLayers = 24;
  const std::size_t texels = std::size_t(view_.size) * std::size_t(view_.size);
  listLimit_ = texels * kBytesOfThreeLayers;
  const Status drawn = draw(programs, lines);
  listLimit_ = SIZE_MAX;
  if (!drawn.ok() && drawn.error().code != ErrorCode::TooLarge) return drawn.error();
  if (!drawn.ok()) {
    lists_.reset();
    bytes_ = 0;
    return false;
  }
  char text[96];
  std::snprintf(text, sizeof text, "%.3g fragments a texel: sorted lists, exact",
                double(lists_->entries()) / double(texels));
  choice_ = text;
  return true;
}

}  // namespace coif::preview
