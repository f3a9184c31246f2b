#include "coif/light/light_density_map.h"

#include <limits>
#include <mutex>
#include <new>

#include "coif/base/lanes.h"
#include "coif/base/parallel.h"
#include "light/light_columns.h"

namespace coif {
namespace {

constexpr int kMostDoublings = 40;
constexpr std::align_val_t kLine{64};  // of the caches: what is streamed to them

using Depths = std::unique_ptr<float[]>;

}  // namespace

/// A slab's optical depths for every thread at work: all zero when nobody has them.
class LightDensityMap::SpareDepths {
 public:
  Depths take(std::size_t size) {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) return std::make_unique<float[]>(size);
    Depths depths = std::move(free_.back());
    free_.pop_back();
    return depths;
  }
  void giveBack(Depths depths) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(depths));
  }

 private:
  std::mutex mutex_;
  std::vector<Depths> free_;
};

LightDensityMap::LightDensityMap(const LightDensityOptions& options)
    : options_(options),
      deposit_(options.log2Size, GridDeposit::Length::AcrossLast),
      values_(static_cast<float*>(::operator new(cells() * sizeof(float), kLine))),
      spare_(std::make_unique<SpareDepths>()) {}

void LightDensityMap::Aligned::operator()(float* values) const {
  ::operator delete(values, kLine);
}

LightDensityMap::LightDensityMap(LightDensityMap&&) noexcept = default;
LightDensityMap& LightDensityMap::operator=(LightDensityMap&&) noexcept = default;
LightDensityMap::~LightDensityMap() = default;

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
void LightDensityMap::gather(const FragmentStream& stream, std::size_t begin, std::size_t end,
                             GridPoint* out) const {
  const StrandSet& strands = stream.strands();
  for (std::size_t s = begin; s < end; ++s) {
    const std::uint64_t first = strands.offsets[s], last = strands.offsets[s + 1];
    if (!stream.usableStrand(s)) {
      std::fill_n(out, last - first, GridPoint{0, 0, 0, -1});
    } else if (view_.perspective) {
      for (std::uint64_t p = first; p < last; ++p) out[p - first] = seenFromPoint(stream, std::uint32_t(p));
    } else {
      gatherDistant(stream, first, last, out);
    }
    out += last - first;
  }
}

void LightDensityMap::gatherDistant(const FragmentStream& stream, std::uint64_t first, std::uint64_t last,
                                    GridPoint* out) const {
  using Four = Lanes<4>::Float;
  const double perCell = 1 / cell_;
  // From a corner that floats can name, so that differences are as fine as the points themselves.
  const Vec3f corner =
      (alongRows() * low_.x() + acrossRows() * low_.y() + view_.forward * low_.z()).cast<float>();
  const Vec3 cells = cellsOf(corner.cast<double>());
  const Four base = {float(cells.x()), float(cells.y()), float(cells.z()), 0};
  Four axes[3];
  for (int d = 0; d < 3; ++d) {
    axes[d] = Four{float(alongRows()[d] * perCell), float(acrossRows()[d] * perCell),
                   float(view_.forward[d] * perCell), 0};
  }
  const Vec3f* points = stream.strands().points.data();
  for (std::uint64_t p = first; p < last; ++p, ++out) {
    const float* world = points[p].data();
    const Four at = (world[0] - corner[0]) * axes[0] + (world[1] - corner[1]) * axes[1] +
                    (world[2] - corner[2]) * axes[2] + base;
    storeLanes(&out->x, at);
    const auto point = std::uint32_t(p);
    out->weight = float(stream.opacityAt(point) * std::max(0.0, stream.widthAt(point)) * perCell);
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

// Slabs [begin, end): hair into cells that stay near the processor, cells into T by columns along the light.
void LightDensityMap::accumulate(std::size_t begin, std::size_t end) {
  const std::size_t n = std::size_t(1) << options_.log2Size, size = deposit_.slabCells();
  const int lanes = widestLanes();
  Depths depths = spare_->take(size);
  for (std::size_t slab = begin; slab < end; ++slab) {
    const std::span passed(values_.get() + slab * size, size);
    if (!deposit_.reaches(int(slab))) {
      std::ranges::fill(passed, 1.0f);
      continue;
    }
    deposit_.add(int(slab), {depths.get(), size}, lanes);
    light::transmittanceByColumns(depths.get(), passed.data(), n * GridDeposit::kSlabRows, n,
                                  std::size_t(deposit_.first()[2]) & (n - 1), lanes);
  }
  spare_->giveBack(std::move(depths));
}

Status LightDensityMap::update(const FragmentStream& stream, const Context& context) {
  view_ = stream.view();
  for (int doubling = 0; doubling <= kMostDoublings; ++doubling) {
    base_ = (low_ / cell_).array().floor();
    deposit_.bin(
        stream.strands().offsets,
        [&](std::size_t begin, std::size_t end, std::span<GridPoint> out) {
          gather(stream, begin, end, out.data());
        },
        context);
    if (context.cancelled()) break;
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
