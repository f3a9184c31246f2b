#include "coif/light/light_density_map.h"

#include <limits>
#include <memory>

#include "coif/base/parallel.h"

namespace coif {
namespace {

constexpr std::size_t kStrandsAChunk = 128;
constexpr int kMostDoublings = 40;

}  // namespace

// In cells; for a point light x and y are the map's, z runs evenly in 1 / depth.
Vec3 LightDensityMap::cellsOf(const Vec3& world) const {
  if (!view_.perspective) {
    return Vec3(view_.up.dot(world), view_.right.dot(world), view_.forward.dot(world)) / cell_ - base_;
  }
  const int n = 1 << options_.log2Size;
  const Vec3 p = view_.project(world);
  const double z = (inverseNear_ - 1 / p.z()) / (inverseNear_ - inverseFar_);
  const double side = double(n - 2) / view_.size;  // a guard cell on every side
  return Vec3(1 + p.x() * side, 1 + p.y() * side, 1 + z * (n - 4));
}

void LightDensityMap::fitCell(const FragmentStream& stream) {
  const StrandSet& strands = stream.strands();
  Vec3 lo = Vec3::Constant(HUGE_VAL), hi = -lo;
  for (std::size_t s = 0; s < strands.strandCount(); ++s) {
    if (!stream.usableStrand(s)) continue;
    for (const Vec3f& point : strands.strand(s)) {
      const Vec3 p = point.cast<double>(), d = p - view_.eye;
      const Vec3 c(view_.up.dot(p), view_.right.dot(p),
                   view_.perspective ? d.dot(view_.forward) : view_.forward.dot(p));
      lo = lo.cwiseMin(c), hi = hi.cwiseMax(c);
    }
  }
  if (!(lo.x() <= hi.x())) lo = Vec3::Zero(), hi = Vec3::Ones();
  if (view_.perspective) {
    const double near = std::max(lo.z(), kNearFraction * view_.depthRange);
    inverseNear_ = 1 / near;
    inverseFar_ = 1 / std::max(hi.z(), near * (1 + 1e-6));
    cell_ = view_.texel * view_.size / ((1 << options_.log2Size) - 2);
    return;
  }
  low_ = lo;
  const double extent = (hi - lo).maxCoeff();
  // One guard cell before and behind; the float's rounding of the points may not reach into them.
  const double fit = std::max(extent, 1e-9 * view_.depthRange) * (1 + 1e-5) / ((1 << options_.log2Size) - 3);
  cell_ = options_.cell > 0 ? options_.cell : fit;
}

// Points in cells and what they weigh there: width / cell, so that weight × length across the light is
// ℓ D |sin ψ| / ds².
bool LightDensityMap::gather(const FragmentStream& stream, const Context& context) {
  const StrandSet& strands = stream.strands();
  points_.resize(strands.points.size());
  base_ = (low_ / cell_).array().floor();
  const double perTexel = double(view_.size) / ((1 << options_.log2Size) - 2);
  parallelFor(context, strands.strandCount(), kStrandsAChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const bool usable = stream.usableStrand(s);
      for (std::uint64_t p = strands.offsets[s]; p < strands.offsets[s + 1]; ++p) {
        const Vec3 world = strands.points[p].cast<double>();
        const double depth = (world - view_.eye).dot(view_.forward);
        if (!usable || (view_.perspective && !(depth * inverseNear_ >= 1 - 1e-9))) {
          points_[p] = {0, 0, 0, -1};
          continue;
        }
        const Vec3 c = cellsOf(world);
        const double cell = view_.perspective ? view_.texelAt(depth) * perTexel : cell_;
        const auto point = std::uint32_t(p);
        const double weight = stream.opacityAt(point) * std::max(0.0, stream.widthAt(point)) / cell;
        const int n = 1 << options_.log2Size;
        const bool off = view_.perspective && !(c.x() >= 1 && c.x() < n - 1 && c.y() >= 1 && c.y() < n - 1);
        points_[p] = {float(c.x()), float(c.y()), float(c.z()), off ? -1.0f : float(weight)};
      }
    }
  });
  return !context.cancelled();
}

// Slabs [begin, end): hair into cells, cells into T by columns along the light.
void LightDensityMap::accumulate(std::size_t begin, std::size_t end, const GridDeposit& deposit) {
  constexpr long kRows = GridDeposit::kSlabRows;
  const long n = 1L << options_.log2Size, mask = n - 1;
  const auto cells = std::make_unique_for_overwrite<float[]>(deposit.slabCells());
  std::vector<std::uint8_t> touched(deposit.slabRows());
  Eigen::ArrayXXf sum(n, kRows), passed(n, kRows);
  const long turn = first_[0] & mask;  // where in a row of the grid the first column lies
  for (std::size_t slab = begin; slab < end; ++slab) {
    std::ranges::fill(touched, std::uint8_t(0));
    deposit.fill(int(slab), std::span(cells.get(), deposit.slabCells()), touched);
    sum.setZero();
    passed.setOnes();
    for (long k = 0; k < n; ++k) {
      for (long j = 0; j < kRows; ++j) {
        const std::size_t at = std::size_t(k * kRows + j);
        if (touched[at]) {
          sum.col(j) += Eigen::Map<const Eigen::ArrayXf>(cells.get() + at * std::size_t(n), n);
          passed.col(j) = (-sum.col(j)).exp();
        }
        const long row = first_[1] + long(slab) * kRows + j;
        float* out = &values_[std::size_t((((first_[2] + k) & mask) * n + (row & mask)) * n)];
        std::copy_n(passed.col(j).data(), n - turn, out + turn);
        std::copy_n(passed.col(j).data() + (n - turn), turn, out);
      }
    }
  }
}

Status LightDensityMap::update(const FragmentStream& stream, const Context& context) {
  view_ = stream.view();
  for (int doubling = 0; doubling <= kMostDoublings; ++doubling) {
    if (!gather(stream, context)) break;
    const GridDeposit deposit(points_, stream.strands().offsets, options_.log2Size,
                              GridDeposit::Length::AcrossLast, context);
    if (!deposit.fits()) {
      if (!options_.grows || view_.perspective) {
        return makeError(ErrorCode::TooLarge,
                         "the hair is longer than the light map's box: take larger cells");
      }
      cell_ *= 2;
      continue;
    }
    first_ = deposit.first();
    constexpr std::size_t kSlabsAChunk = 2;
    parallelFor(context, std::size_t(deposit.slabCount()), kSlabsAChunk,
                [&](std::size_t begin, std::size_t end) { accumulate(begin, end, deposit); });
    dropped_ = stream.droppedStrands();
    if (context.cancelled()) break;
    return {};
  }
  return makeError(ErrorCode::Cancelled, "the light map was cancelled");
}

Result<LightDensityMap> LightDensityMap::make(const FragmentStream& stream,
                                              const LightDensityOptions& options, const Context& context) {
  if (options.log2Size < 3 || options.log2Size > 9 || !(options.cell >= 0 && std::isfinite(options.cell))) {
    return makeError(ErrorCode::InvalidArgument, "a light map has 8 … 512 cells a side, of positive size");
  }
  LightDensityMap map;
  map.view_ = stream.view();
  map.options_ = options;
  map.values_.resize(std::size_t(1) << (3 * options.log2Size));
  map.fitCell(stream);
  COIF_TRY(map.update(stream, context));
  return map;
}

// T behind cell (i, j, k): 1 before the hair and beside the box, that of the last cell behind it.
float LightDensityMap::face(long i, long j, long k) const {
  const long n = 1L << options_.log2Size, mask = n - 1;
  const auto outside = [&](long v, long first) { return v < first || v >= first + n; };
  if (outside(i, first_[0]) || outside(j, first_[1]) || k < first_[2]) return 1;
  k = std::min(k, first_[2] + n - 1);
  return values_[((std::size_t(k & mask) * std::size_t(n) + std::size_t(j & mask)) * std::size_t(n)) +
                 std::size_t(i & mask)];
}

double LightDensityMap::transmittance(const Vec3& world) const {
  if (!world.allFinite()) return 1;
  if (view_.perspective && !((world - view_.eye).dot(view_.forward) * inverseNear_ > 0)) return 1;
  const Vec3 c = cellsOf(world);
  if (!(c.cwiseAbs().maxCoeff() < 1e15)) return 1;
  const double x = std::floor(c.x() - 0.5), y = std::floor(c.y() - 0.5), z = std::floor(c.z());
  const double fx = c.x() - 0.5 - x, fy = c.y() - 0.5 - y, fz = c.z() - z;
  double result = 0;
  for (int t = 0; t < 8; ++t) {
    const double weight = (t & 1 ? fx : 1 - fx) * (t & 2 ? fy : 1 - fy) * (t & 4 ? fz : 1 - fz);
    result += weight * double(face(long(x) + (t & 1), long(y) + (t >> 1 & 1), long(z) - 1 + (t >> 2)));
  }
  return std::clamp(result, 0.0, 1.0);
}

}  // namespace coif
