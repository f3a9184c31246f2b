#include "coif/strands/sampler.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "coif/base/check.h"
#include "coif/base/parallel.h"

namespace coif {
namespace {

constexpr std::size_t kGrain = 1024;  // strands a chunk: enough to pay for the columns of a bundle
constexpr std::size_t kManyStrands =
    64;  // a bundle: then keeping all columns costs a tenth of the points at most
constexpr double kBlendCurvature = 6;  // max |s″| of the fading s(u) = (1−u)²(1+2u)

double fading(double u) {
  return u < 1 ? (1 - u) * (1 - u) * (1 + 2 * u) : 0;
}

// Wider vectors where the machine has them, chosen as the program is loaded; the same bits, as no sum is
// reordered or fused (-ffp-contract=off). ThreadSanitizer's own code would run in the choice, before it is
// set up.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__ELF__) && \
    !defined(__SANITIZE_THREAD__)
#define COIF_WIDEST __attribute__((target_clones("default", "avx2", "avx512f")))
#else
#define COIF_WIDEST
#endif

/// out = Σ weights[i] · columns[i], columns `stride` apart. The sums run in corner order for any vector
/// width.
COIF_WIDEST void weightedSum(const float* __restrict columns, std::size_t stride,
                             std::span<const float> weights, std::size_t size, float* __restrict out) {
  const float* c = columns;
  if (weights.size() == 4) {
    const float a = weights[0], b = weights[1], d = weights[2], e = weights[3];
    for (std::size_t j = 0; j < size; ++j) {
      out[j] = a * c[j] + b * c[stride + j] + d * c[2 * stride + j] + e * c[3 * stride + j];
    }
    return;
  }
  const float a = weights[0], b = weights[1], d = weights[2];
  for (std::size_t j = 0; j < size; ++j) out[j] = a * c[j] + b * c[stride + j] + d * c[2 * stride + j];
  for (std::size_t i = 3; i < weights.size(); ++i) {
    const float w = weights[i];
    const float* column = columns + i * stride;
    for (std::size_t j = 0; j < size; ++j) out[j] += w * column[j];
  }
}

std::vector<Vec3> columnOf(const HairMesh& mesh, const Bundle& bundle, std::uint32_t corner) {
  std::vector<Vec3> out;
  for (std::uint32_t k = 0; k <= bundle.height(); ++k) out.push_back(mesh.position(bundle.face(k)[corner]));
  return out;
}

std::uint64_t pointsOf(std::span<const std::uint32_t> pieces) {
  return std::accumulate(pieces.begin(), pieces.end(), std::uint64_t{1});
}

}  // namespace

Vec3 cagePoint(const HairMesh& mesh, const RootSet& roots, std::size_t root) {
  const auto face = mesh.bundles()[roots.bundles[root]].face(0);
  const auto weights = roots.weightsOf(root);
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < face.size(); ++i) sum += double(weights[i]) * mesh.position(face[i]);
  return sum;
}

/// Samples the columns of one bundle after another.
class StrandSampler::Worker {
 public:
  explicit Worker(const StrandSampler& sampler) : s_(sampler) {}

  void load(std::uint32_t bundle) {
    if (bundle == bundle_) return;
    bundle_ = bundle;
    const Bundle& b = s_.mesh_.bundles()[bundle];
    const bool adaptive = s_.options_.tolerance.has_value();
    if (adaptive || s_.options_.knots != Knots::Uniform || b.height() != height_) {
      height_ = b.height();
      parameters_ =
          adaptive ? pieceParameters(s_.pieces_[bundle]) : evenParameters(height_, s_.options_.points);
      table_ = SplineTable(s_.intervalsOf(b), parameters_);
      const auto first = std::lower_bound(parameters_.begin(), parameters_.end(), 1.0) - parameters_.begin();
      fading_.resize(std::size_t(first));
      for (std::size_t p = 0; p < fading_.size(); ++p) fading_[p] = float(fading(parameters_[p]));
      along_.resize(parameters_.size());
      for (std::size_t p = 0; p < along_.size(); ++p) along_[p] = float(parameters_[p] / double(height_));
    }
    sampleColumns(b);
  }

  void write(std::size_t root, float* out) const {
    const auto weights = s_.roots_.weightsOf(root);
    const std::size_t size = s_.extentOf(root).size, skipped = parameters_.size() - size;
    const std::size_t kept = fading_.size() - skipped;  // points of the first segment
    if (skipped == 0) {
      weightedSum(columns_.data(), stride(), weights, 3 * size, out);
    } else {
      for (std::size_t p = 0; p < kept; ++p) {
        weightedSum(columns_.data() + 3 * p * (fading_.size() / kept), stride(), weights, 3, out + 3 * p);
      }
      weightedSum(columns_.data() + 3 * fading_.size(), stride(), weights, 3 * (size - kept), out + 3 * kept);
    }
    if (!s_.rootPoints_.empty()) lift(s_.rootPoints_[root], fading_.size() / kept, kept, out);
  }

  void writeWidths(std::size_t root, float rootWidth, float tipWidth, float* out) const {
    const std::size_t size = s_.extentOf(root).size, skipped = parameters_.size() - size;
    const std::size_t kept = fading_.size() - skipped;
    for (std::size_t p = 0; p < kept; ++p)
      out[p] = mix(rootWidth, tipWidth, along_[p * (fading_.size() / kept)]);
    for (std::size_t p = kept; p < size; ++p) out[p] = mix(rootWidth, tipWidth, along_[p + skipped]);
  }

  /// Greatest distance from the spline to the polyline `points` of a strand.
  double chordError(std::size_t root, std::span<const Vec3f> points) const;

 private:
  static float mix(float a, float b, float t) { return (1 - t) * a + t * b; }
  std::size_t stride() const { return 3 * parameters_.size(); }

  void sampleColumns(const Bundle& b) {
    columns_.assign(b.corners * stride(), 0.0f);
    for (std::uint32_t i = 0; i < b.corners; ++i) {
      const std::vector<Vec3> column = columnOf(s_.mesh_, b, i);
      for (std::size_t p = 0; p < parameters_.size(); ++p) {
        Vec3 sum = Vec3::Zero();
        const auto row = table_.row(p);
        for (std::size_t k = 0; k < row.size(); ++k) {
          if (row[k] != 0) sum += row[k] * column[k];
        }
        for (int axis = 0; axis < 3; ++axis)
          columns_[i * stride() + 3 * p + std::size_t(axis)] = float(sum[axis]);
      }
    }
  }

  void lift(const Vec3f& target, std::size_t step, std::size_t count, float* out) const {
    for (int axis = 0; axis < 3; ++axis) {
      const float by = target[axis] - out[axis];
      for (std::size_t p = 1; p < count; ++p) out[3 * p + std::size_t(axis)] += fading_[p * step] * by;
      out[axis] = target[axis];
    }
  }

  const StrandSampler& s_;
  std::uint32_t bundle_ = kNone, height_ = kNone;
  std::vector<double> parameters_;
  SplineTable table_{std::vector<double>{1}, {}};
  std::vector<float> columns_;
  std::vector<float> fading_;  // of the points below parameter 1
  std::vector<float> along_;   // parameter over height, of all points
};

double StrandSampler::Worker::chordError(std::size_t root, std::span<const Vec3f> points) const {
  constexpr int kBetween = 16;
  const Bundle& b = s_.mesh_.bundles()[bundle_];
  const auto weights = s_.roots_.weightsOf(root);
  std::vector<Vec3> control(height_ + 1, Vec3::Zero());
  for (std::uint32_t k = 0; k <= height_; ++k) {
    for (std::uint32_t i = 0; i < b.corners; ++i)
      control[k] += double(weights[i]) * s_.mesh_.position(b.face(k)[i]);
  }
  const Vec3 by =
      s_.rootPoints_.empty() ? Vec3::Zero() : Vec3(s_.rootPoints_[root].cast<double>() - control[0]);
  const std::vector<double> intervals = s_.intervalsOf(b);
  std::vector<double> row(control.size());
  const std::size_t skipped = parameters_.size() - points.size(), kept = fading_.size() - skipped;
  const auto parameter = [&](std::size_t p) {
    return parameters_[p < kept ? p * (fading_.size() / kept) : p + skipped];
  };
  double worst = 0;
  for (std::size_t p = 0; p + 1 < points.size(); ++p) {
    const Vec3 a = points[p].cast<double>(), chord = points[p + 1].cast<double>() - a;
    for (int j = 1; j < kBetween; ++j) {
      const double t = parameter(p) + (parameter(p + 1) - parameter(p)) * j / kBetween;
      splineWeights(intervals, t, row);
      Vec3 at = fading(t) * by;
      for (std::size_t k = 0; k < control.size(); ++k) at += row[k] * control[k];
      const double along =
          chord.squaredNorm() > 0 ? std::clamp(chord.dot(at - a) / chord.squaredNorm(), 0.0, 1.0) : 0;
      worst = std::max(worst, (at - a - along * chord).norm());
    }
  }
  return worst;
}

StrandSampler::StrandSampler(const HairMesh& mesh, const RootSet& roots, const SamplingOptions& options,
                             std::span<const Vec3f> rootPoints, const Context& context)
    : mesh_(mesh), roots_(roots), options_(options), rootPoints_(rootPoints) {
  COIF_CHECK(options.tolerance ? *options.tolerance > 0 : options.points >= 2,
             "the caller checked the sampling");
  COIF_CHECK(rootPoints.empty() || rootPoints.size() == roots.size(), "a root point a root, or none");
  offsets_.resize(roots.size() + 1);
  if (options.tolerance) {
    planAdaptive(context);
  } else {
    for (std::size_t r = 0; r < roots.size(); ++r) offsets_[r + 1] = (r + 1) * std::uint64_t(options.points);
  }
}

std::vector<double> StrandSampler::intervalsOf(const Bundle& bundle) const {
  std::vector<double> lengths(bundle.height(), 0.0);
  for (std::uint32_t k = 0; k < bundle.height(); ++k) {
    for (std::uint32_t i = 0; i < bundle.corners; ++i) {
      lengths[k] += (mesh_.position(bundle.face(k + 1)[i]) - mesh_.position(bundle.face(k)[i])).norm();
    }
  }
  return knotIntervals(lengths, options_.knots);  // only ratios matter: the sum serves as the mean
}

void StrandSampler::planAdaptive(const Context& context) {
  pieces_.resize(mesh_.bundles().size());
  parallelFor(context, pieces_.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) pieces_[b] = planBundle(b);
  });
  for (std::size_t r = 0; r < roots_.size(); ++r) offsets_[r + 1] += offsets_[r];
}

/// Pieces of each segment for a bundle; offsets_[r + 1] becomes the number of points of its strand r.
std::vector<std::uint32_t> StrandSampler::planBundle(std::size_t index) {
  const Bundle& bundle = mesh_.bundles()[index];
  const auto roots =
      std::span(roots_.byBundle)
          .subspan(roots_.bundleStarts[index], roots_.bundleStarts[index + 1] - roots_.bundleStarts[index]);
  if (roots.empty()) return {};
  const std::vector<double> intervals = intervalsOf(bundle);
  std::vector<double> bounds(bundle.height(), 0.0);  // of |P″| in each segment
  for (std::uint32_t i = 0; i < bundle.corners; ++i) {
    const std::vector<Vec3> column = columnOf(mesh_, bundle, i);
    for (std::uint32_t k = 0; k < bundle.height(); ++k) {
      for (const Vec3& second : secondDerivatives(column, intervals, k)) {
        bounds[k] = std::max(bounds[k], second.norm());
      }
    }
  }
  double spread = 1;  // max Σ|λ|
  for (const std::uint32_t r : roots) {
    double sum = 0;
    for (const float w : roots_.weightsOf(r)) sum += std::abs(w);
    spread = std::max(spread, sum);
  }
  if (spread > 1.001) {  // negative weights; a power of two, to change seldom with the number of strands
    for (double& bound : bounds) bound *= std::exp2(std::ceil(std::log2(spread)));
  }
  std::vector<std::uint32_t> pieces;
  for (const double bound : bounds) pieces.push_back(chordPieces(bound, *options_.tolerance));
  const std::uint64_t rest = pointsOf(pieces) - pieces[0];
  if (rootPoints_.empty()) {
    for (const std::uint32_t r : roots) offsets_[r + 1] = rest + pieces[0];
    return pieces;
  }
  pieces[0] = 1;
  for (const std::uint32_t r : roots) {
    const double lift = (rootPoints_[r].cast<double>() - cagePoint(mesh_, roots_, r)).norm();
    const std::uint32_t own =
        std::bit_ceil(chordPieces(bounds[0] + kBlendCurvature * lift, *options_.tolerance));
    offsets_[r + 1] = rest + own;
    pieces[0] = std::max(pieces[0], own);
  }
  return pieces;
}

void StrandSampler::evaluate(std::span<Vec3f> points, const Context& context) const {
  evaluate(points, {}, 0, 0, context);
}

void StrandSampler::evaluate(std::span<Vec3f> points, std::span<float> widths, float rootWidth,
                             float tipWidth, const Context& context) const {
  COIF_CHECK(points.size() == pointCount() && (widths.empty() || widths.size() == pointCount()),
             "room for every point");
  forEachStrand(context, [&](const Worker& worker, std::size_t r) {
    worker.write(r, points[offsets_[r]].data());
    if (!widths.empty()) worker.writeWidths(r, rootWidth, tipWidth, &widths[offsets_[r]]);
  });
}

/// Many strands a bundle: all bundles are sampled first, then strands go in their own order, so that memory
/// is written in one stream (scattered writes cost more than the reads from the second-level cache). Few:
/// bundle by bundle, one bundle's columns at a time. The bytes are the same.
template <class Write>
void StrandSampler::forEachStrand(const Context& context, const Write& write) const {
  const std::size_t bundles = mesh_.bundles().size();
  if (roots_.size() / kManyStrands >= bundles) {
    std::vector<Worker> workers(bundles, Worker(*this));
    parallelFor(context, bundles, 8, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) {
        if (roots_.bundleStarts[b] < roots_.bundleStarts[b + 1]) workers[b].load(std::uint32_t(b));
      }
    });
    parallelFor(context, roots_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t r = begin; r < end; ++r) write(workers[roots_.bundles[r]], r);
    });
    return;
  }
  parallelFor(context, roots_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    Worker worker(*this);
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t r = roots_.byBundle[i];
      worker.load(roots_.bundles[r]);
      write(worker, r);
    }
  });
}

double StrandSampler::chordError(std::span<const Vec3f> points, std::size_t samples) const {
  Worker worker(*this);
  double worst = 0;
  samples = std::min(samples, roots_.size());
  for (std::size_t i = 0; i < samples; ++i) {
    const std::size_t r = i * roots_.size() / samples;
    worker.load(roots_.bundles[r]);
    const Extent extent = extentOf(r);
    worst = std::max(worst, worker.chordError(r, points.subspan(extent.begin, extent.size)));
  }
  return worst;
}

}  // namespace coif
