#include "coif/strands/strand_set.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace coif {
namespace {

Error malformed(std::string message, std::string place = {}) {
  return makeError(ErrorCode::InvalidArgument, std::move(message), std::move(place));
}

std::string strandPlace(std::size_t strand) {
  return "strand " + std::to_string(strand);
}

Status checkOffsets(std::span<const std::uint64_t> offsets, std::uint64_t end, const char* what) {
  if (offsets.empty() || offsets.front() != 0) return malformed(std::string(what) + " must start with 0");
  for (std::size_t s = 0; s + 1 < offsets.size(); ++s) {
    if (offsets[s + 1] < offsets[s]) return malformed(std::string(what) + " descend", strandPlace(s));
  }
  if (offsets.back() != end) {
    return malformed(std::string(what) + " end at " + std::to_string(offsets.back()) + ", the array at " +
                     std::to_string(end));
  }
  return {};
}

/// The strand that owns a point.
std::size_t strandOf(const StrandSet& strands, std::size_t point) {
  const auto next = std::upper_bound(strands.offsets.begin(), strands.offsets.end(), std::uint64_t(point));
  return std::size_t(next - strands.offsets.begin()) - 1;
}

/// Index of the first value that is not finite, or count.
std::size_t firstNotFinite(const float* values, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    if (!std::isfinite(values[i])) return i;
  }
  return count;
}

Status checkLengths(const StrandSet& set) {
  const std::size_t s = set.strandCount(), p = set.pointCount();
  struct Entry {
    const char* name;
    std::size_t size, wanted;
  };
  const std::array<Entry, 8> entries{{{"widths", set.widths.size(), p},
                                      {"colors", set.colors.size(), p},
                                      {"transparencies", set.transparencies.size(), p},
                                      {"ids", set.ids.size(), s},
                                      {"root faces", set.rootFaces.size(), s},
                                      {"root UVs", set.rootUvs.size(), s},
                                      {"groups", set.groups.size(), s},
                                      {"guide flags", set.guides.size(), s}}};
  for (const Entry& entry : entries) {
    if (entry.size != 0 && entry.size != entry.wanted) {
      return malformed("the array of " + std::string(entry.name) + " has " + std::to_string(entry.size) +
                       " elements, not " + std::to_string(entry.wanted));
    }
  }
  if (set.weightOffsets.empty()) {
    if (!set.weights.empty()) return malformed("there are weights without weight offsets");
    return {};
  }
  if (set.weightOffsets.size() != s + 1) {
    return malformed("there are " + std::to_string(set.weightOffsets.size()) + " weight offsets, not " +
                     std::to_string(s + 1));
  }
  return checkOffsets(set.weightOffsets, set.weights.size(), "weight offsets");
}

Status checkFinite(const StrandSet& set) {
  const auto faultAt = [&](std::size_t point, const char* what) {
    const std::size_t s = strandOf(set, point);
    return malformed(std::string(what) + " is not finite",
                     strandPlace(s) + ", point " + std::to_string(point - set.offsets[s]));
  };
  if (!set.points.empty()) {
    const std::size_t at = firstNotFinite(set.points[0].data(), 3 * set.points.size());
    if (at < 3 * set.points.size()) return faultAt(at / 3, "a position");
  }
  const std::size_t width = firstNotFinite(set.widths.data(), set.widths.size());
  if (width < set.widths.size()) return faultAt(width, "a width");
  return {};
}

template <class T>
std::uint64_t bytesOf(const std::vector<T>& array) {
  return array.size() * sizeof(T);
}

}  // namespace

std::uint64_t StrandSet::bytes() const {
  return bytesOf(offsets) + bytesOf(points) + bytesOf(widths) + bytesOf(ids) + bytesOf(rootFaces) +
         bytesOf(weightOffsets) + bytesOf(weights) + bytesOf(rootUvs) + bytesOf(groups) + bytesOf(guides) +
         bytesOf(colors) + bytesOf(transparencies);
}

Status validate(const StrandSet& set, bool requireFinite) {
  COIF_TRY(checkOffsets(set.offsets, set.points.size(), "strand offsets"));
  COIF_TRY(checkLengths(set));
  for (std::size_t s = 0; s < set.groups.size(); ++s) {
    if (set.groups[s] >= set.groupNames.size()) {
      return malformed("group " + std::to_string(set.groups[s]) + " is not one of the " +
                           std::to_string(set.groupNames.size()) + " named groups",
                       strandPlace(s));
    }
  }
  return requireFinite ? checkFinite(set) : Status{};
}

float widthAt(const StrandSet& strands, std::size_t point) {
  constexpr float kHairM = 8e-5f;
  if (!strands.widths.empty()) return strands.widths[point];
  return kHairM / float(strands.metersPerUnit > 0 ? strands.metersPerUnit : 0.01);
}

bool drawable(const StrandSet& strands, std::size_t s) {
  const std::size_t begin = strands.offsets[s], end = strands.offsets[s + 1];
  if (end < begin + 2) return false;
  for (std::size_t p = begin; p < end; ++p) {
    const float width = widthAt(strands, p);
    if (!strands.points[p].allFinite() || !std::isfinite(width) || width < 0) return false;
    if (!strands.colors.empty() && !strands.colors[p].allFinite()) return false;
  }
  return true;
}

}  // namespace coif
