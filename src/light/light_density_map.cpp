#include "coif/light/light_density_map.h"

#include <limits>

#include "coif/base/lanes.h"
#include "coif/base/parallel.h"
#include "light/light_columns.h"

namespace coif {
namespace {

constexpr std::size_t kStrandsAChunk = 128;
constexpr int kMostDoublings = 40;

}  // namespace

LightDensityMap::LightDensityMap(const LightDensityOptions& options)
    : options_(options),
      deposit_(options.log2Size, GridDeposit::Length::AcrossLast),
      values_(std::make_unique_for_overwrite<float[]>(cells())) {}

// In cells; for a point light x and y are the map's, z runs evenly in 1 / depth.
Vec3 LightDensityMap::cellsOf(const Vec3& world) const {
  if (!view_.perspective) {
    return Vec3(alongRows().dot(world), acrossRows().dot(world), view_.forward.dot(world)) / cell_ - base_;
  }
  const int n = 1 << options_.log2Size;
  const Vec3 p = view_.project(world);
  const double z = (inverseNear_ - 1 / p.z()) / (inverseNear_ - inverseFar_);
  const double side = double(n - 2) / view_.size;  // a guard cell on every side
  return Vec3(1 + p.x() * side, 1 + p.y() * side, 1 + z * (n - 4));
}

void LightDensityMap::fitCell(const FragmentStream& stream) {
  const StrandSet& strands = stream.strands();
  Vec3 lo = Vec3::Constant(HUGE_VAL), hi = -lo, travelled = Vec3::Zero();
  for (std::size_t s = 0; s < strands.strandCount(); ++s) {
    if (!stream.usableStrand(s)) continue;
    Vec3 last = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    for (const Vec3f& point : strands.strand(s)) {
      const Vec3 p = point.cast<double>(), d = p - view_.eye;
      const Vec3 c(view_.up.dot(p), view_.right.dot(p),
                   view_.perspective ? d.dot(view_.forward) : view_.forward.dot(p));
      lo = lo.cwiseMin(c), hi = hi.cwiseMax(c);
      if (last.allFinite()) travelled += (c - last).cwiseAbs();
      last = c;
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
  // Rows along the hair: neighbours in memory, and fewer hairs that cross from slab to slab.
  rowsAlongRight_ = travelled.y() > travelled.x();
  if (rowsAlongRight_) std::swap(lo.x(), lo.y()), std::swap(hi.x(), hi.y());
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
  parallelFor(context, strands.strandCount(), kStrandsAChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const std::uint64_t first = strands.offsets[s], last = strands.offsets[s + 1];
      if (!stream.usableStrand(s)) {
        std::fill(points_.begin() + std::ptrdiff_t(first), points_.begin() + std::ptrdiff_t(last),
                  GridPoint{0, 0, 0, -1});
      } else if (view_.perspective) {
        for (std::uint64_t p = first; p < last; ++p) points_[p] = seenFromPoint(stream, std::uint32_t(p));
      } else {
        gatherDistant(stream, first, last);
      }
    }
  });
  return !context.cancelled();
}

void LightDensityMap::gatherDistant(const FragmentStream& stream, std::uint64_t first, std::uint64_t last) {
  const double perCell = 1 / cell_;
  const Vec3 x = perCell * alongRows(), y = perCell * acrossRows(), z = perCell * view_.forward;
  for (std::uint64_t p = first; p < last; ++p) {
    const Vec3 world = stream.strands().points[p].cast<double>();
    const auto point = std::uint32_t(p);
    const double weight = stream.opacityAt(point) * std::max(0.0, stream.widthAt(point)) * perCell;
    points_[p] = {float(x.dot(world) - base_.x()), float(y.dot(world) - base_.y()),
                  float(z.dot(world) - base_.z()), float(weight)};
  }
}

GridPoint LightDensityMap::seenFromPoint(const FragmentStream& stream, std::uint32_t point) const {
  const Vec3 world = stream.strands().points[point].cast<double>();
  const double depth = (world - view_.eye).dot(view_.forward);
  if (!(depth * inverseNear_ >= 1 - 1e-9)) return {0, 0, 0, -1};
  const Vec3 c = cellsOf(world);
  const int n = 1 << options_.log2Size;
  if (!(c.x() >= 1 && c.x() < n - 1 && c.y() >= 1 && c.y() < n - 1)) return {0, 0, 0, -1};
  const double cell = view_.texelAt(depth) * double(view_.size) / (n - 2);
  const double weight = stream.opacityAt(point) * std::max(0.0, stream.widthAt(point)) / cell;
  return {float(c.x()), float(c.y()), float(c.z()), float(weight)};
}

// Slabs [begin, end): hair into cells, cells into T by columns along the light, in place.
void LightDensityMap::accumulate(std::size_t begin, std::size_t end) {
  const std::size_t n = std::size_t(1) << options_.log2Size;
  const int lanes = widestLanes();
  for (std::size_t slab = begin; slab < end; ++slab) {
    const std::span<float> cells(values_.get() + slab * deposit_.slabCells(), deposit_.slabCells());
    if (!deposit_.reaches(int(slab))) {
      std::ranges::fill(cells, 1.0f);
      continue;
    }
    deposit_.fill(int(slab), cells, lanes);
    light::transmittanceByColumns(cells.data(), n * GridDeposit::kSlabRows, n,
                                  std::size_t(deposit_.first()[2]) & (n - 1), lanes);
  }
}

Status LightDensityMap::update(const FragmentStream& stream, const Context& context) {
  view_ = stream.view();
  for (int doubling = 0; doubling <= kMostDoublings; ++doubling) {
    if (!gather(stream, context)) break;
    deposit_.bin(points_, stream.strands().offsets, context);
    if (!deposit_.fits()) {
      if (!options_.grows || view_.perspective) {
        return makeError(ErrorCode::TooLarge,
                         "the hair is longer than the light map's box: take larger cells");
      }
      cell_ *= 2;
      continue;
    }
    parallelFor(context, std::size_t(deposit_.slabCount()), 1,
                [&](std::size_t begin, std::size_t end) { accumulate(begin, end); });
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
  LightDensityMap map(options);
  map.view_ = stream.view();
  map.fitCell(stream);
  COIF_TRY(map.update(stream, context));
  return map;
}

// T behind cell (i, j, k): 1 before the hair and beside the box, that of the last cell behind it.
float LightDensityMap::face(long i, long j, long k) const {
  const long n = 1L << options_.log2Size;
  const auto& first = deposit_.first();
  const auto outside = [&](long v, long least) { return v < least || v >= least + n; };
  if (outside(i, first[0]) || outside(j, first[1]) || k < first[2]) return 1;
  k = std::min(k, first[2] + n - 1);
  const std::size_t slab = std::size_t(j & (n - 1)) / GridDeposit::kSlabRows;
  return values_[slab * deposit_.slabCells() + deposit_.cellInSlab(i, j, k)];
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
