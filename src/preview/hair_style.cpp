// What the preview keeps of a style: for the GPU that of all strands, for planning that of a few.
#include <algorithm>
#include <cmath>

#include "coif/base/parallel.h"
#include "preview/hair_model.h"

namespace coif::preview {
namespace {

Error invalid(std::string why) {
  return makeError(ErrorCode::InvalidArgument, std::move(why));
}

Status check(const HairModel& model, const StrandStyle& style) {
  const std::size_t strands = model.places.size();
  if (style.strandOffsets.size() != strands + 1 || style.reach.size() != strands ||
      style.rootTurns.size() != strands || style.strandOffsets.back() != style.offsets.size() ||
      !(style.widths.empty() || style.widths.size() == style.offsets.size()))
    return invalid("the style was planned for other strands than are shown");
  const std::uint64_t n = style.strandOffsets[1];
  for (std::size_t s = 0; s < strands; ++s) {
    if (style.strandOffsets[s + 1] - style.strandOffsets[s] != n)
      return invalid("a style on the GPU wants strands of equally many points");
    if (n > 0 && !style.offsets[s * n].isZero(0))
      return invalid("the style moves strand " + std::to_string(s) + " off its root");
  }
  if (n < 2) return invalid("a styled strand needs at least two points");
  return {};
}

/// Of a few strands at a few of their points.
SampledStyle sampledStyle(const StrandStyle& style, const SampledRoots& of, std::uint32_t points) {
  SampledStyle out;
  out.points = points;
  const std::uint64_t n = style.strandOffsets[1];
  for (const std::uint64_t s : of.roots.ids) {
    out.reach.push_back(style.reach[s]), out.turns.push_back(style.rootTurns[s]);
    for (std::uint32_t p = 0; p < points; ++p) {
      const std::size_t at = s * n + pointTaken(p, points, std::uint32_t(n));
      out.offsets.push_back(style.offsets[at]);
      if (!style.widths.empty()) out.widths.push_back(style.widths[at]);
    }
  }
  return out;
}

}  // namespace

void SampledRoots::add(const StrandSet& strands, std::size_t s, std::uint32_t bundle) {
  roots.ids.push_back(s);
  roots.bundles.push_back(bundle);
  if (roots.weightOffsets.empty()) roots.weightOffsets.push_back(0);
  for (std::uint64_t w = strands.weightOffsets[s]; w < strands.weightOffsets[s + 1]; ++w)
    roots.weights.push_back(strands.weights[w]);
  roots.weightOffsets.push_back(roots.weights.size());
  landings.push_back(strands.points[strands.offsets[s]]);
  widths.push_back(widthAt(strands, strands.offsets[s]));
  widths.push_back(widthAt(strands, strands.offsets[s + 1] - 1));
}

void SampledRoots::sort(std::size_t bundles) {
  if (roots.weightOffsets.empty()) roots.weightOffsets.push_back(0);
  roots.bundleStarts.assign(bundles + 1, 0);
  for (const std::uint32_t b : roots.bundles) ++roots.bundleStarts[b + 1];
  for (std::size_t b = 0; b < bundles; ++b) roots.bundleStarts[b + 1] += roots.bundleStarts[b];
  std::vector<std::uint64_t> next = roots.bundleStarts;
  roots.byBundle.resize(roots.size());
  for (std::size_t r = 0; r < roots.size(); ++r) roots.byBundle[next[roots.bundles[r]]++] = std::uint32_t(r);
}

Result<std::vector<Eigen::Vector4f>> prepareStyle(HairModel& model, const StrandStyle& style,
                                                  std::size_t maxPoints, const Context& context) {
  model.styled = false;
  model.coarseStyle = model.exampleStyle = {};
  for (HairModel::Members& lock : model.members) lock.longer = 1;
  if (style.empty() || model.strands == 0) {
    model.sample(context);
    return std::vector<Eigen::Vector4f>();
  }
  COIF_TRY(check(model, style));
  const auto n = std::uint32_t(style.strandOffsets[1]);
  model.styled = true;
  model.styledPoints = n;
  model.styledStrands = std::min(model.strands, (maxPoints - model.locks.size()) / n);
  std::vector<Eigen::Vector4f> out(model.locks.size() + model.styledStrands * n);
  std::vector<std::uint32_t> starts(model.locks.size()), counts(model.locks.size());
  std::uint32_t start = 0;
  for (std::size_t l = 0; l < model.locks.size(); ++l) {
    HairModel::Members& members = model.members[l];
    members.mostPoints = n;
    counts[l] = std::uint32_t(std::ranges::lower_bound(members.ranks, std::uint32_t(model.styledStrands)) -
                              members.ranks.begin());
    starts[l] = start;
    out[l] = {float(start), 0, 0, 0};  // whole up to 2^24 strands, which is more than fit
    start += counts[l];
  }
  std::vector<std::uint32_t> lockOf;  // by place in the sorted roots
  for (std::uint32_t l = 0; l < model.locks.size(); ++l)
    lockOf.insert(lockOf.end(), model.members[l].ranks.size(), l);
  parallelFor(context, model.places.size(), 2048, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      if (model.places[s] == kNone) continue;
      const std::uint32_t lock = lockOf[model.places[s]],
                          within = model.places[s] - model.locks[lock].rootStart;
      if (within >= counts[lock]) continue;
      Eigen::Vector4f* to = out.data() + model.locks.size() + std::size_t(starts[lock] + within) * n;
      for (std::uint32_t p = 0; p < n; ++p) {
        const Vec3f& offset = style.offsets[s * n + p];
        to[p] = {offset.x(), offset.y(), offset.z(), style.widths.empty() ? 1.0f : style.widths[s * n + p]};
      }
      to[0].head<2>() = Eigen::Vector2f(style.reach[s], style.rootTurns[s]);
    }
  });
  model.coarseStyle = sampledStyle(style, model.coarseRoots, kCoarsePoints);
  model.exampleStyle = sampledStyle(style, model.exampleRoots, n);
  model.sample(context);
  return out;
}

}  // namespace coif::preview
