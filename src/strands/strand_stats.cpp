#include "coif/strands/strand_stats.h"

#include <algorithm>
#include <limits>

#include "coif/base/parallel.h"

namespace coif {
namespace {

constexpr std::size_t kGrain = 4096;

struct Partial {
  std::uint64_t notFinite = 0, zeroLength = 0;
  std::uint64_t fewest = std::numeric_limits<std::uint64_t>::max(), most = 0;
  double shortest = std::numeric_limits<double>::infinity(), longest = 0, sum = 0;
  double least = std::numeric_limits<double>::infinity(), greatest = 0;
  Vec3f lo = Vec3f::Constant(std::numeric_limits<float>::infinity()), hi = -lo;

  void add(const Partial& o) {
    notFinite += o.notFinite, zeroLength += o.zeroLength, sum += o.sum;
    fewest = std::min(fewest, o.fewest), most = std::max(most, o.most);
    shortest = std::min(shortest, o.shortest), longest = std::max(longest, o.longest);
    least = std::min(least, o.least), greatest = std::max(greatest, o.greatest);
    lo = lo.cwiseMin(o.lo), hi = hi.cwiseMax(o.hi);
  }
};

void addStrand(const StrandSet& set, std::size_t s, Partial& to) {
  const auto points = set.strand(s);
  double length = 0;
  const Vec3f* previous = nullptr;
  for (const Vec3f& p : points) {
    if (!p.allFinite()) {
      ++to.notFinite;
      continue;
    }
    if (previous != nullptr) length += (p - *previous).cast<double>().norm();
    previous = &p;
    to.lo = to.lo.cwiseMin(p), to.hi = to.hi.cwiseMax(p);
  }
  to.zeroLength += previous != nullptr && length == 0;
  to.fewest = std::min<std::uint64_t>(to.fewest, points.size());
  to.most = std::max<std::uint64_t>(to.most, points.size());
  to.shortest = std::min(to.shortest, length), to.longest = std::max(to.longest, length);
  to.sum += length;
  if (set.widths.empty()) return;
  for (std::uint64_t p = set.offsets[s]; p < set.offsets[s + 1]; ++p) {
    to.least = std::min(to.least, double(set.widths[p])),
    to.greatest = std::max(to.greatest, double(set.widths[p]));
  }
}

}  // namespace

StrandStats strandStats(const StrandSet& set, const Context& context) {
  StrandStats stats;
  stats.strands = set.strandCount(), stats.points = set.pointCount();
  if (stats.strands == 0) return stats;
  std::vector<Partial> partials((stats.strands + kGrain - 1) / kGrain);
  parallelFor(context, stats.strands, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) addStrand(set, s, partials[begin / kGrain]);
  });
  Partial all;
  for (const Partial& partial : partials) all.add(partial);
  stats.notFinite = all.notFinite, stats.zeroLength = all.zeroLength;
  stats.fewestPoints = all.fewest, stats.mostPoints = all.most;
  stats.shortest = all.shortest, stats.longest = all.longest;
  stats.meanLength = all.sum / double(stats.strands);
  if (all.least <= all.greatest) stats.least = all.least, stats.greatest = all.greatest;
  if ((all.lo.array() <= all.hi.array()).all()) stats.box = {all.lo.cast<double>(), all.hi.cast<double>()};
  return stats;
}

double insideFraction(const StrandSet& set, const Surface& surface, std::size_t skip, std::size_t samples,
                      const Context& context) {
  std::uint64_t wanted = 0;
  for (std::size_t s = 0; s < set.strandCount(); ++s)
    wanted += set.strand(s).size() - std::min(skip, set.strand(s).size());
  const std::uint64_t step =
      std::max<std::uint64_t>(1, samples > 0 ? (wanted + samples - 1) / samples : wanted);
  std::vector<Vec3> queries;
  std::uint64_t counter = 0;
  for (std::size_t s = 0; s < set.strandCount(); ++s) {
    const auto strand = set.strand(s);
    for (std::size_t p = skip; p < strand.size(); ++p) {
      if (counter++ % step == 0 && strand[p].allFinite()) queries.push_back(strand[p].cast<double>());
    }
  }
  if (queries.empty()) return 0;
  std::vector<double> winding(queries.size());
  surface.windingNumbers(context, queries, winding);
  const auto inside = std::count_if(winding.begin(), winding.end(), [](double w) { return w > 0.5; });
  return double(inside) / double(queries.size());
}

}  // namespace coif
