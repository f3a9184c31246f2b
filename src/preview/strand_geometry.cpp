#include "preview/strand_geometry.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "coif/base/parallel.h"
#include "coif/base/random.h"

namespace coif::preview {
namespace {

constexpr double kTolerancePx = 0.3;
constexpr double kLongestPx = 32;
constexpr double kRibbonPx = 0.4;             // the level of detail widens hairs to about this
constexpr std::size_t kLeastStrands = 12000;  // below, single hairs are told apart
constexpr float kDefaultWidthM = 8e-5f;

float widthOf(const StrandSet& strands, std::size_t point) {
  if (!strands.widths.empty()) return strands.widths[point];
  return kDefaultWidthM / float(strands.metersPerUnit > 0 ? strands.metersPerUnit : 0.01);
}

bool usable(const StrandSet& strands, std::size_t s) {
  const std::size_t begin = strands.offsets[s], end = strands.offsets[s + 1];
  if (end < begin + 2) return false;
  for (std::size_t p = begin; p < end; ++p) {
    if (!strands.points[p].allFinite() || !std::isfinite(widthOf(strands, p)) || widthOf(strands, p) < 0)
      return false;
    if (!strands.colors.empty() && !strands.colors[p].allFinite()) return false;
  }
  return true;
}

// Indices that stay, by recursive splitting at the point farthest from the chord (Ramer, Douglas & Peucker).
void simplify(std::span<const Vec3f> curve, const View& view, std::vector<std::uint32_t>& kept) {
  const std::uint32_t last = std::uint32_t(curve.size() - 1);
  kept = {0};
  std::vector<std::uint32_t> ends{last};  // stack of the right ends still to reach
  while (!ends.empty()) {
    const std::uint32_t a = kept.back(), b = ends.back();
    const Vec3 pa = curve[a].cast<double>(), pb = curve[b].cast<double>();
    const double pixel = std::min(view.pixelAt(pa), view.pixelAt(pb));
    const Vec3 chord = pb - pa;
    const double squared = chord.squaredNorm();
    double worst = 0;
    std::uint32_t split = (a + b) / 2;
    for (std::uint32_t i = a + 1; i < b; ++i) {
      const Vec3 d = curve[i].cast<double>() - pa;
      const double t = squared > 0 ? std::clamp(d.dot(chord) / squared, 0.0, 1.0) : 0.0;
      const double distance = (d - t * chord).norm();
      if (distance > worst) worst = distance, split = i;
    }
    if (b == a + 1 || (worst < kTolerancePx * pixel && std::sqrt(squared) < kLongestPx * pixel)) {
      kept.push_back(b);
      ends.pop_back();
    } else {
      if (worst < kTolerancePx * pixel) split = (a + b) / 2;
      ends.push_back(split);
    }
  }
}

void appendStrand(const StrandSet& strands, std::size_t s, double widthScale,
                  std::span<const std::uint32_t> kept, StrandPoint* out) {
  const std::size_t begin = strands.offsets[s], last = strands.offsets[s + 1] - begin - 1;
  const auto curve = strands.strand(s);
  const std::uint64_t id = strands.ids.empty() ? s : strands.ids[s];
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const std::size_t i = kept[k];
    StrandPoint& point = out[k];
    point.position = curve[i];
    point.width = float(widthOf(strands, begin + i) * widthScale);
    const Vec3 d = (curve[std::min(i + 1, last)] - curve[i == 0 ? 0 : i - 1]).cast<double>();
    point.tangent = d.stableNormalized().cast<float>();
    point.seed = std::uint32_t(mix64(id + 1));
    point.color = strands.colors.empty() ? Vec3f(0, 0, 0) : strands.colors[begin + i];
    point.along = float(i) / float(last);
  }
}

// Length of the prefix to draw.
std::size_t prefixLength(const StrandSet& strands, const View& view, const DetailOptions& detail) {
  const std::size_t count = strands.strandCount();
  if (!detail.lod || count <= kLeastStrands) return count;
  double width = 0, segments = 0;
  std::size_t looked = 0;
  std::vector<std::uint32_t> kept;
  for (std::size_t s = 0; s < count; s += std::max<std::size_t>(count / 512, 1)) {
    if (!usable(strands, s)) continue;
    const std::size_t middle = (strands.offsets[s] + strands.offsets[s + 1]) / 2;
    width += widthOf(strands, middle) / view.pixelAt(strands.points[middle].cast<double>());
    simplify(strands.strand(s), view, kept);
    segments += double(kept.size() - 1);
    ++looked;
  }
  if (looked == 0) return count;
  const double share = width / double(looked) / kRibbonPx;
  const double bound = double(detail.maxSegments) / std::max(segments / double(looked), 1.0);
  const double wanted = std::min(std::max(double(count) * share, double(kLeastStrands)), bound);
  return std::clamp(std::size_t(wanted), std::size_t{1}, count);
}

}  // namespace

Box finiteBounds(const StrandSet& strands) {
  Box box;
  bool first = true;
  for (const Vec3f& p : strands.points) {
    if (!p.allFinite()) continue;
    const Vec3 d = p.cast<double>();
    box.lo = first ? d : Vec3(box.lo.cwiseMin(d));
    box.hi = first ? d : Vec3(box.hi.cwiseMax(d));
    first = false;
  }
  return box;
}

StrandGeometry makeStrandGeometry(const StrandSet& strands, const View& view, const DetailOptions& detail,
                                  const Context& context) {
  StrandGeometry result;
  result.box = finiteBounds(strands);
  result.colored = !strands.colors.empty();
  const std::size_t prefix = prefixLength(strands, view, detail);
  if (prefix > 0) result.widthScale = double(strands.strandCount()) / double(prefix);

  constexpr std::size_t kGrain = 512;
  struct Chunk {
    std::vector<StrandPoint> points;
    std::vector<std::uint32_t> sizes;
    std::size_t dropped = 0;
  };
  std::vector<Chunk> chunks((prefix + kGrain - 1) / kGrain);
  parallelFor(context, prefix, kGrain, [&](std::size_t begin, std::size_t end) {
    Chunk& chunk = chunks[begin / kGrain];
    std::vector<std::uint32_t> kept;
    for (std::size_t s = begin; s < end; ++s) {
      if (!usable(strands, s)) {
        ++chunk.dropped;
        continue;
      }
      if (detail.lod) {
        simplify(strands.strand(s), view, kept);
      } else {
        kept.resize(strands.strand(s).size());
        for (std::size_t i = 0; i < kept.size(); ++i) kept[i] = std::uint32_t(i);
      }
      chunk.points.resize(chunk.points.size() + kept.size());
      chunk.sizes.push_back(std::uint32_t(kept.size()));
      appendStrand(strands, s, result.widthScale, kept,
                   chunk.points.data() + chunk.points.size() - kept.size());
    }
  });
  for (const Chunk& chunk : chunks) {
    result.points.insert(result.points.end(), chunk.points.begin(), chunk.points.end());
    for (const std::uint32_t size : chunk.sizes) result.starts.push_back(result.starts.back() + size);
    result.dropped += chunk.dropped;
  }
  return result;
}

std::vector<std::uint32_t> StrandGeometry::stripIndices() const {
  std::vector<std::uint32_t> indices;
  indices.reserve(2 * points.size() + starts.size());
  for (std::size_t s = 0; s + 1 < starts.size(); ++s) {
    for (std::uint32_t p = starts[s]; p < starts[s + 1]; ++p) {
      indices.push_back(2 * p);
      indices.push_back(2 * p + 1);
    }
    indices.push_back(kNone);
  }
  return indices;
}

}  // namespace coif::preview
