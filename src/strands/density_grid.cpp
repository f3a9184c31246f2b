#include "coif/strands/density_grid.h"

#include <algorithm>
#include <cmath>

#include "coif/base/lanes.h"
#include "coif/base/parallel.h"
#include "strands/deposit_lanes.h"

namespace coif {
namespace {

constexpr std::size_t kStrandsAChunk = 256;
constexpr float kFarthest = 1 << 30;  // in cells: whole numbers of them stay exact in long and int
constexpr double kQuarterPi = 0.78539816339744831;

/// x, y, z of points; their weights come along because four floats are one load.
struct CellRange {
  Eigen::Array4f lo = Eigen::Array4f::Constant(HUGE_VALF), hi = -lo;
  void add(const GridPoint& p) {
    const Eigen::Map<const Eigen::Array4f> v(&p.x);
    lo = lo.min(v), hi = hi.max(v);
  }
};
static_assert(sizeof(GridPoint) == 4 * sizeof(float));

bool usable(const GridPoint& p) {
  return p.weight >= 0;
}

/// Points [begin, end) of one strand, all usable, and their slabs (not wrapped): a run for every stretch of
/// points in one slab, with the segments that lead there and away, and single segments where slabs are passed
/// over.
void binStretches(std::span<std::vector<SegmentRun>> bins, const int* slabOf, std::uint32_t begin,
                  std::uint32_t end, std::uint32_t base) {
  if (end - begin < 2) return;
  const int slabs = int(bins.size());
  const auto add = [&](int slab, std::uint32_t first, std::uint32_t last) {
    bins[std::size_t(slab & (slabs - 1))].push_back({first, last - first});
  };
  std::uint32_t first = begin;
  int a = slabOf[begin - base];
  for (std::uint32_t p = begin; p + 1 < end; ++p) {
    const int b = slabOf[p + 1 - base];
    if (a == b) continue;
    add(a, first, p + 1);
    const int step = a < b ? 1 : -1, far = std::abs(b - a);
    for (int at = 1; at < std::min(far, slabs); ++at) add(a + at * step, p, p + 1);
    first = far < slabs ? p : p + 1;  // a whole turn: the slab has this segment
    a = b;
  }
  if (first + 1 < end) add(a, first, end - 1);
}

}  // namespace

GridDeposit::GridDeposit(int log2Size, Length length) : log2Size_(log2Size), length_(length) {}

void GridDeposit::bin(std::span<const GridPoint> points, std::span<const std::uint64_t> offsets,
                      const Context& context) {
  points_ = points;
  first_ = {0, 0, 0};
  fits_ = true;
  const std::size_t strands = offsets.empty() ? 0 : offsets.size() - 1;
  bins_.resize((strands + kStrandsAChunk - 1) / kStrandsAChunk);
  std::vector<CellRange> ranges(bins_.size());
  const int slabs = slabCount();
  static_assert(kSlabRows == 8);
  parallelFor(context, strands, kStrandsAChunk, [&](std::size_t begin, std::size_t end) {
    auto& bins = bins_[begin / kStrandsAChunk];
    bins.resize(std::size_t(slabs));
    for (auto& bin : bins) bin.clear();
    const std::uint64_t first = offsets[begin], count = offsets[end] - first;
    // Ahead of what branches, so that it is done several at a time.
    std::vector<int> slabOf(count);
    CellRange range;
    for (std::uint64_t p = 0; p < count; ++p) {
      const float y = std::min(kFarthest, std::max(-kFarthest, points[first + p].y));  // NaN becomes far
      const int whole = int(y);
      slabOf[p] = (whole - (y < float(whole))) >> 3;
    }
    for (std::size_t s = begin; s < end; ++s) {
      auto from = std::uint32_t(offsets[s]);
      for (std::uint64_t p = offsets[s]; p < offsets[s + 1]; ++p) {
        if (usable(points[p])) {
          range.add(points[p]);
          continue;
        }
        binStretches(bins, slabOf.data(), from, std::uint32_t(p), std::uint32_t(first));
        from = std::uint32_t(p + 1);
      }
      binStretches(bins, slabOf.data(), from, std::uint32_t(offsets[s + 1]), std::uint32_t(first));
    }
    ranges[begin / kStrandsAChunk] = range;
  });
  CellRange all;
  for (const CellRange& range : ranges) all.lo = all.lo.min(range.lo), all.hi = all.hi.max(range.hi);
  if (!(all.lo[0] <= all.hi[0])) return;
  for (int d = 0; d < 3; ++d) {
    if (!(all.lo[d] > -kFarthest && all.hi[d] < kFarthest)) {
      fits_ = false;
      return;
    }
    first_[std::size_t(d)] = floorToLong(all.lo[d]) - 1;
    fits_ = fits_ && floorToLong(all.hi[d]) - first_[std::size_t(d)] < (1L << log2Size_);
  }
}

bool GridDeposit::reaches(int slab) const {
  return std::ranges::any_of(bins_, [&](const auto& bins) { return !bins[std::size_t(slab)].empty(); });
}

void GridDeposit::fill(int slab, std::span<float> cells, int lanes) const {
  std::ranges::fill(cells, 0.0f);
  DepositTask task;
  task.points = points_;
  for (int d = 0; d < 3; ++d) {
    task.origin[d] = float(first_[std::size_t(d)] & ~((1L << log2Size_) - 1));
  }
  task.log2Size = log2Size_;
  task.rowBegin = slab * kSlabRows;
  task.acrossLast = length_ == Length::AcrossLast;
  task.cells = cells.data();
  for (const auto& bins : bins_) {
    task.runs = bins[std::size_t(slab)];
    depositSegments(task, lanes > 0 ? lanes : widestLanes());
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
  GridDeposit deposit(frame.log2Size, GridDeposit::Length::Whole);
  deposit.bin(points, strands.offsets, context);
  if (!deposit.fits()) {
    return makeError(ErrorCode::TooLarge,
                     "the hair is longer than the density grid's box: take larger cells");
  }
  DensityGrid grid{frame, std::vector<float>(std::size_t(1) << (3 * frame.log2Size), 0.0f)};
  const long size = frame.size();
  parallelFor(context, std::size_t(deposit.slabCount()), 1, [&](std::size_t begin, std::size_t end) {
    std::vector<float> cells(deposit.slabCells());
    for (std::size_t slab = begin; slab < end; ++slab) {
      if (!deposit.reaches(int(slab))) continue;
      deposit.fill(int(slab), cells);
      for (long k = 0; k < size; ++k) {
        for (long row = 0; row < GridDeposit::kSlabRows; ++row) {
          const long j = long(slab) * GridDeposit::kSlabRows + row;
          std::copy_n(&cells[deposit.cellInSlab(0, j, k)], size, &grid.values[frame.index(0, j, k)]);
        }
      }
    }
  });
  if (context.cancelled()) return makeError(ErrorCode::Cancelled, "the density grid was cancelled");
  if (report != nullptr) report->droppedStrands = std::size_t(std::count(bad.begin(), bad.end(), 1));
  return grid;
}

}  // namespace coif
