#include "coif/strands/density_grid.h"

#include <limits>

#include "coif/base/parallel.h"

namespace coif {
namespace {

constexpr std::size_t kPointsAChunk = 8192;
constexpr double kFarthest = 1 << 30;  // in cells; forEachCell's range
constexpr std::size_t kAhead = 8;      // segments
constexpr double kQuarterPi = 0.78539816339744831;

struct CellRange {
  std::array<float, 3> lo{HUGE_VALF, HUGE_VALF, HUGE_VALF}, hi{-HUGE_VALF, -HUGE_VALF, -HUGE_VALF};
  void add(const GridPoint& p) {
    const float v[] = {p.x, p.y, p.z};
    for (int d = 0; d < 3; ++d) lo[d] = std::min(lo[d], v[d]), hi[d] = std::max(hi[d], v[d]);
  }
};

bool usable(const GridPoint& p) {
  return p.weight >= 0;
}

/// Marks where strands end: no segment begins there.
std::vector<std::uint8_t> lastPoints(std::span<const std::uint64_t> offsets, std::size_t points) {
  std::vector<std::uint8_t> last(points, 0);
  for (std::size_t s = 0; s + 1 < offsets.size(); ++s) {
    if (offsets[s + 1] > offsets[s]) last[offsets[s + 1] - 1] = 1;
  }
  return last;
}

}  // namespace

GridDeposit::GridDeposit(std::span<const GridPoint> points, std::span<const std::uint64_t> offsets,
                         int log2Size, Length length, const Context& context)
    : log2Size_(log2Size), length_(length) {
  const std::size_t chunks = (points.size() + kPointsAChunk - 1) / kPointsAChunk;
  std::vector<CellRange> ranges(chunks);
  parallelFor(context, points.size(), kPointsAChunk, [&](std::size_t begin, std::size_t end) {
    CellRange range;
    for (std::size_t p = begin; p < end; ++p) {
      if (usable(points[p])) range.add(points[p]);
    }
    ranges[begin / kPointsAChunk] = range;
  });
  CellRange all;
  for (const CellRange& range : ranges) {
    for (int d = 0; d < 3; ++d)
      all.lo[d] = std::min(all.lo[d], range.lo[d]), all.hi[d] = std::max(all.hi[d], range.hi[d]);
  }
  if (!(all.lo[0] <= all.hi[0])) return;
  for (int d = 0; d < 3; ++d) {
    if (!(double(all.lo[d]) > -kFarthest && double(all.hi[d]) < kFarthest)) {
      fits_ = false;
      return;
    }
    first_[std::size_t(d)] = long(std::floor(all.lo[d])) - 1;
    fits_ = fits_ && long(std::floor(all.hi[d])) - first_[std::size_t(d)] < (1L << log2Size_);
  }
  if (!fits_) return;
  const std::vector<std::uint8_t> last = lastPoints(offsets, points.size());
  bins_.resize(chunks);
  const std::array<float, 3> origin{float(first_[0]), float(first_[1]), float(first_[2])};
  const auto moved = [&](const GridPoint& p) {
    return GridPoint{p.x - origin[0], p.y - origin[1], p.z - origin[2], p.weight};
  };
  parallelFor(context, points.size(), kPointsAChunk, [&](std::size_t begin, std::size_t end) {
    auto& bins = bins_[begin / kPointsAChunk];
    bins.resize(std::size_t(slabCount()));
    for (std::size_t p = begin; p < end; ++p) {
      if (last[p] || !usable(points[p]) || !usable(points[p + 1])) continue;
      const Segment segment{moved(points[p]), moved(points[p + 1])};
      const int from = int(std::min(segment.a.y, segment.b.y)) / kSlabRows;
      const int to = int(std::max(segment.a.y, segment.b.y)) / kSlabRows;
      for (int slab = from; slab <= to; ++slab) bins[std::size_t(slab)].push_back(segment);
    }
  });
}

void GridDeposit::fill(int slab, std::span<float> cells, std::span<std::uint8_t> touched) const {
  const long size = 1L << log2Size_, rowBegin = long(slab) * kSlabRows;
  for (const auto& chunk : bins_) {
    for (const auto& [u, v] : chunk[std::size_t(slab)]) {
      const Vec3f a(u.x, u.y, u.z), b(v.x, v.y, v.z);
      Vec3f d = b - a;
      if (length_ == Length::AcrossLast) d.z() = 0;
      const float whole = d.norm(), weight = u.weight * whole, grow = 0.5f * (v.weight - u.weight) * whole;
      forEachCell(a, b, [&](long i, long j, long k, float from, float to) {
        const long row = j - rowBegin;
        if (row < 0 || row >= kSlabRows) return;
        const std::size_t at = std::size_t(k * kSlabRows + row);
        float* line = &cells[at << log2Size_];
        if (!touched[at]) {
          touched[at] = 1;
          std::fill_n(line, size, 0.0f);
        }
        line[i] += (weight + (from + to) * grow) * (to - from);
      });
    }
  }
}

Result<DensityGrid> depositHairVolume(const StrandSet& strands, const GridFrame& frame, double defaultWidth,
                                      const Context& context, DensityReport* report) {
  if (!(frame.cell > 0) || frame.log2Size < 3 || frame.log2Size > 10 || !(defaultWidth >= 0)) {
    return makeError(ErrorCode::InvalidArgument, "a density grid needs positive cells, 8 … 1024 a side");
  }
  COIF_TRY(validate(strands, false));
  std::vector<GridPoint> points(strands.points.size());
  std::vector<std::uint8_t> bad(strands.strandCount(), 0);
  constexpr std::size_t kStrands = 256;
  parallelFor(context, strands.strandCount(), kStrands, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      for (std::uint64_t p = strands.offsets[s]; p < strands.offsets[s + 1]; ++p) {
        const Vec3f c = frame.cellsFromWorld(strands.points[p].cast<double>()).cast<float>();
        const double width = strands.widths.empty() ? defaultWidth : std::max(0.0, double(strands.widths[p]));
        points[p] = {c.x(), c.y(), c.z(), float(kQuarterPi * width * width / (frame.cell * frame.cell))};
        bad[s] |= !c.allFinite() || !std::isfinite(points[p].weight);
      }
      for (std::uint64_t p = strands.offsets[s]; bad[s] && p < strands.offsets[s + 1]; ++p)
        points[p].weight = -1;
    }
  });
  const GridDeposit deposit(points, strands.offsets, frame.log2Size, GridDeposit::Length::Whole, context);
  if (!deposit.fits()) {
    return makeError(ErrorCode::TooLarge,
                     "the hair is longer than the density grid's box: take larger cells");
  }
  DensityGrid grid{frame, std::vector<float>(std::size_t(1) << (3 * frame.log2Size), 0.0f)};
  const long size = frame.size();
  parallelFor(context, std::size_t(deposit.slabCount()), 1, [&](std::size_t begin, std::size_t end) {
    std::vector<float> cells(deposit.slabCells());
    std::vector<std::uint8_t> touched(deposit.slabRows());
    for (std::size_t slab = begin; slab < end; ++slab) {
      std::ranges::fill(touched, std::uint8_t(0));
      deposit.fill(int(slab), cells, touched);
      for (std::size_t row = 0; row < touched.size(); ++row) {
        if (!touched[row]) continue;
        const long j =
            deposit.first()[1] + long(slab * GridDeposit::kSlabRows + row % GridDeposit::kSlabRows);
        const long k = deposit.first()[2] + long(row / GridDeposit::kSlabRows);
        for (long i = 0; i < size; ++i) {
          grid.values[frame.index(deposit.first()[0] + i, j, k)] =
              cells[row * std::size_t(size) + std::size_t(i)];
        }
      }
    }
  });
  if (context.cancelled()) return makeError(ErrorCode::Cancelled, "the density grid was cancelled");
  if (report != nullptr) report->droppedStrands = std::size_t(std::count(bad.begin(), bad.end(), 1));
  return grid;
}

}  // namespace coif
