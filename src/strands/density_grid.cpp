#include "coif/strands/density_grid.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <memory>

#include "coif/base/lanes.h"
#include "coif/base/parallel.h"
#include "strands/deposit_lanes.h"

namespace coif {
namespace {

constexpr std::size_t kStrandsAChunk = 256, kQuad = 4;
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

/// A stretch of points in one slab, with those that its segments lead from and to.
struct Run {
  int slab;  ///< wrapped
  std::uint32_t first, last;
};

/// Points of some strands, where their slabs change, and the runs that follow from it.
class Stretches {
 public:
  Stretches(std::span<const GridPoint> points, int slabs)
      : slabs_(slabs),
        slabOf_(std::make_unique_for_overwrite<int[]>(points.size() + kQuad)),
        changes_(std::make_unique_for_overwrite<std::uint8_t[]>(points.size() + sizeof(std::uint64_t))) {
    std::memset(changes_.get() + points.size(), 0, sizeof(std::uint64_t));
    for (std::size_t p = 0; p < points.size(); p += kQuad) {
      const std::size_t last = points.size() - 1;
      Lanes<kQuad>::Float y;
      for (std::size_t q = 0; q < kQuad; ++q) y[q] = points[std::min(p + q, last)].y;
      y = y < kFarthest ? y : kFarthest + Lanes<kQuad>::Float{};  // NaN becomes far
      y = y > -kFarthest ? y : -kFarthest + Lanes<kQuad>::Float{};
      Lanes<kQuad>::Int whole = __builtin_convertvector(y, Lanes<kQuad>::Int);
      whole += y < __builtin_convertvector(whole, Lanes<kQuad>::Float);  // true is −1
      static_assert(GridDeposit::kSlabRows == 8);
      storeLanes(slabOf_.get() + p, Lanes<kQuad>::Int(whole >> 3));
    }
    for (std::size_t p = 0; p + 1 < points.size(); ++p) changes_[p] = slabOf_[p] != slabOf_[p + 1];
  }

  /// Points [begin, end) of one strand.
  void add(std::uint32_t begin, std::uint32_t end) {
    if (end - begin < 2) return;
    std::uint32_t first = begin;
    forEachChange(begin, end - 1, [&](std::uint32_t p) {
      const int a = slabOf_[p], b = slabOf_[p + 1], step = a < b ? 1 : -1, far = std::abs(b - a);
      push(a, first, p + 1);
      for (int at = 1; at < std::min(far, slabs_); ++at) push(a + at * step, p, p + 1);
      first = far < slabs_ ? p : p + 1;  // a whole turn: the slab has this segment
    });
    if (first + 1 < end) push(slabOf_[end - 1], first, end - 1);
  }

  std::span<const Run> runs() const { return runs_; }

 private:
  void push(int slab, std::uint32_t first, std::uint32_t last) {
    runs_.push_back({slab & (slabs_ - 1), first, last});
  }
  template <class Call>
  void forEachChange(std::uint32_t begin, std::uint32_t end, const Call& call) const {
    for (std::uint32_t p = begin; p < end; p += sizeof(std::uint64_t)) {
      std::uint64_t eight;
      std::memcpy(&eight, changes_.get() + p, sizeof eight);
      if (end - p < sizeof eight) eight &= (std::uint64_t{1} << (8 * (end - p))) - 1;
      for (; eight != 0; eight &= eight - 1) call(p + std::uint32_t(std::countr_zero(eight)) / 8);
    }
  }
  static_assert(std::endian::native == std::endian::little);

  int slabs_;
  std::unique_ptr<int[]> slabOf_;            ///< not wrapped
  std::unique_ptr<std::uint8_t[]> changes_;  ///< 1: the next point lies in another
  std::vector<Run> runs_;
};

CellRange rangeOf(std::span<const GridPoint> points) {
  CellRange range;
  for (const GridPoint& p : points) range.add(p);
  return range;
}

bool usable(const GridPoint& p) {
  return p.weight >= 0;
}

}  // namespace

std::span<const GridPoint> GridDeposit::Chunk::in(int slab) const {
  const auto* begin = begins.data() + slab;
  return std::span(points).subspan(begin[0], begin[1] - begin[0]);
}

GridDeposit::GridDeposit(int log2Size, Length length) : log2Size_(log2Size), length_(length) {}

namespace {

/// Copies the runs' points, slab by slab.
void sortRuns(std::span<const GridPoint> points, std::span<const Run> runs, int slabs,
              std::vector<GridPoint>& sorted, std::vector<std::uint32_t>& begins) {
  begins.assign(std::size_t(slabs) + 1, 0);
  for (const Run& run : runs) begins[std::size_t(run.slab) + 1] += run.last + 1 - run.first;
  for (std::size_t slab = 0; slab < std::size_t(slabs); ++slab) begins[slab + 1] += begins[slab];
  sorted.resize(begins.back() + kReadBehind);
  std::vector<std::uint32_t> at = begins;
  for (const Run& run : runs) {
    std::uint32_t& to = at[std::size_t(run.slab)];
    const std::uint32_t count = run.last + 1 - run.first;
    std::memcpy(sorted.data() + to, points.data() + run.first, count * sizeof(GridPoint));
    to += count;
    sorted[to - 1].weight = lastOfRun(points[run.last].weight);
  }
}

}  // namespace

void GridDeposit::bin(std::span<const std::uint64_t> offsets, const Source& source, const Context& context) {
  first_ = {0, 0, 0};
  fits_ = true;
  const std::size_t strands = offsets.empty() ? 0 : offsets.size() - 1;
  chunks_.resize((strands + kStrandsAChunk - 1) / kStrandsAChunk);
  std::vector<CellRange> ranges(chunks_.size());
  parallelFor(context, strands, kStrandsAChunk, [&](std::size_t begin, std::size_t end) {
    const std::size_t count = offsets[end] - offsets[begin];
    const auto memory = std::make_unique_for_overwrite<GridPoint[]>(count);
    const std::span<GridPoint> points(memory.get(), count);
    source(begin, end, points);
    Stretches stretches(points, slabCount());
    CellRange& range = ranges[begin / kStrandsAChunk];
    range = rangeOf(points);
    const bool allUsable = range.lo[3] >= 0;
    if (!allUsable) range = {};
    for (std::size_t s = begin; s < end; ++s) {
      auto from = std::uint32_t(offsets[s] - offsets[begin]);
      const auto last = std::uint32_t(offsets[s + 1] - offsets[begin]);
      for (std::uint32_t p = from; !allUsable && p < last; ++p) {
        if (usable(points[p])) {
          range.add(points[p]);
          continue;
        }
        stretches.add(from, p);
        from = p + 1;
      }
      stretches.add(from, last);
    }
    Chunk& chunk = chunks_[begin / kStrandsAChunk];
    sortRuns(points, stretches.runs(), slabCount(), chunk.points, chunk.begins);
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
  return std::ranges::any_of(chunks_, [&](const Chunk& chunk) { return !chunk.in(slab).empty(); });
}

void GridDeposit::add(int slab, std::span<float> cells, int lanes) const {
  DepositTask task;
  for (int d = 0; d < 3; ++d) {
    task.origin[d] = float(first_[std::size_t(d)] & ~((1L << log2Size_) - 1));
  }
  task.log2Size = log2Size_;
  task.rowBegin = slab * kSlabRows;
  task.acrossLast = length_ == Length::AcrossLast;
  task.cells = cells.data();
  for (const Chunk& chunk : chunks_) {
    task.points = chunk.in(slab);
    depositSegments(task, lanes > 0 ? lanes : widestLanes());
  }
}

Result<DensityGrid> depositHairVolume(const StrandSet& strands, const GridFrame& frame, double defaultWidth,
                                      const Context& context, DensityReport* report) {
  if (!(frame.cell > 0) || frame.log2Size < 3 || frame.log2Size > 10 || !(defaultWidth >= 0)) {
    return makeError(ErrorCode::InvalidArgument, "a density grid needs positive cells, 8 … 1024 a side");
  }
  COIF_TRY(validate(strands, false));
  std::vector<std::uint8_t> bad(strands.strandCount(), 0);
  const auto inCells = [&](std::size_t begin, std::size_t end, std::span<GridPoint> out) {
    GridPoint* to = out.data();
    for (std::size_t s = begin; s < end; ++s) {
      GridPoint* const first = to;
      for (std::uint64_t p = strands.offsets[s]; p < strands.offsets[s + 1]; ++p) {
        const Vec3f c = frame.cellsFromWorld(strands.points[p].cast<double>()).cast<float>();
        const double width = strands.widths.empty() ? defaultWidth : std::max(0.0, double(strands.widths[p]));
        *to = {c.x(), c.y(), c.z(), float(kQuarterPi * width * width / (frame.cell * frame.cell))};
        bad[s] |= !c.allFinite() || !std::isfinite(to->weight);
        ++to;
      }
      if (bad[s]) std::fill(first, to, GridPoint{0, 0, 0, -1});
    }
  };
  GridDeposit deposit(frame.log2Size, GridDeposit::Length::Whole);
  deposit.bin(strands.offsets, inCells, context);
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
      std::ranges::fill(cells, 0.0f);
      deposit.add(int(slab), cells);
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
