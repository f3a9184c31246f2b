#include "preview/detail.h"

#include <algorithm>
#include <cmath>

#include "coif/base/parallel.h"

namespace coif::preview {
namespace {

constexpr std::uint32_t kFine = 8;  // samples of a segment between control points, before simplification
constexpr double kThinPx = 3;       // wider ribbons show how segments meet
constexpr double kEnough = 0.9;     // of the examples must keep the tolerance

double stepped(double size) {
  return size > 0 ? std::exp2(std::floor(4 * std::log2(size)) / 4) : size;
}

double fading(double t) {
  return t < 1 ? (1 - t) * (1 - t) * (1 + 2 * t) : 0;
}

/// Columns of a lock at many parameters, and how much of the lift is left there.
struct FineColumns {
  std::vector<double> parameters, lift;
  std::vector<std::vector<Vec3>> columns;
};

FineColumns fineColumns(const HairModel& model, const Lock& lock, double maxLift) {
  FineColumns fine;
  fine.parameters = evenParameters(lock.height, lock.height * kFine + 1);
  const SplineTable table(model.intervals(lock), fine.parameters);
  for (const double t : fine.parameters) fine.lift.push_back(fading(t) * maxLift);
  for (std::uint32_t i = 0; i < lock.corners; ++i) {
    const std::vector<Vec3> control = model.column(lock, i);
    auto& column = fine.columns.emplace_back(fine.parameters.size(), Vec3::Zero());
    for (std::size_t p = 0; p < column.size(); ++p) {
      for (std::size_t k = 0; k < control.size(); ++k) {
        if (table.row(p)[k] != 0) column[p] += table.row(p)[k] * control[k];
      }
    }
  }
  return fine;
}

double distanceToChord(const Vec3& p, const Vec3& a, const Vec3& chord) {
  const double squared = chord.squaredNorm();
  const double t = squared > 0 ? std::clamp((p - a).dot(chord) / squared, 0.0, 1.0) : 0.0;
  return (p - a - t * chord).norm();
}

/// Of all samples between a and b the one farthest from the chords of its columns.
struct Worst {
  std::size_t sample;
  double distance, longest;
};
Worst worstBetween(const FineColumns& fine, std::size_t a, std::size_t b) {
  Worst worst{(a + b) / 2, 0, 0};
  for (const auto& column : fine.columns)
    worst.longest = std::max(worst.longest, (column[b] - column[a]).norm());
  for (std::size_t i = a + 1; i < b; ++i) {
    double distance = 0;
    for (const auto& column : fine.columns)
      distance = std::max(distance, distanceToChord(column[i], column[a], column[b] - column[a]));
    const double t = double(i - a) / double(b - a);
    distance += std::abs(fine.lift[i] - (1 - t) * fine.lift[a] - t * fine.lift[b]);
    if (distance > worst.distance) worst.distance = distance, worst.sample = i;
  }
  return worst;
}

/// Parameters that stay, by recursive splitting at the worst sample (Ramer, Douglas & Peucker), all columns
/// at once: a strand is a weighted mean of them.
std::vector<float> simplified(const FineColumns& fine, double tolerance, double longest) {
  std::vector<float> kept{float(fine.parameters.front())};
  std::vector<std::size_t> ends{fine.parameters.size() - 1};
  std::size_t a = 0;
  while (!ends.empty()) {
    const std::size_t b = ends.back();
    const Worst worst = worstBetween(fine, a, b);
    const bool close = worst.distance < tolerance;
    if (b == a + 1 || (close && worst.longest < longest)) {
      kept.push_back(float(fine.parameters[b]));
      ends.pop_back();
      a = b;
    } else {
      ends.push_back(close ? (a + b) / 2 : worst.sample);
    }
  }
  return kept;
}

double smallestPixel(const HairModel& model, const Lock& lock, const PixelSize& pixelAt) {
  double pixel = INFINITY;
  for (std::uint32_t i = 0; i < lock.corners * (lock.height + 1); ++i)
    pixel = std::min(pixel, pixelAt(model.mesh.position(model.bundleVertices[lock.vertexStart + i])));
  return stepped(pixel);
}

bool goodEnough(std::span<const Vec3> curve, std::uint32_t samples, double tolerance, double longest) {
  std::size_t a = 0;
  for (std::uint32_t k = 1; k < samples; ++k) {
    const std::size_t b = pointTaken(k, samples, std::uint32_t(curve.size()));
    const Vec3 chord = curve[b] - curve[a];
    if (b > a + 1 && chord.norm() > longest) return false;
    for (std::size_t i = a + 1; i < b; ++i) {
      if (distanceToChord(curve[i], curve[a], chord) > tolerance) return false;
    }
    a = b;
  }
  return true;
}

/// Points a strand of a lock of strands that came as points, or are styled.
std::uint32_t importedSamples(const HairModel::Members& lock, const DetailOptions& options,
                              const PixelSize& pixelAt) {
  const std::uint32_t most = lock.mostPoints;
  for (std::uint32_t step = 0; options.lod && ladderSegments(step) + 1 < most; ++step) {
    std::size_t good = 0;
    for (const auto& example : lock.examples) {
      double pixel = INFINITY;
      for (const Vec3& p : example) pixel = std::min(pixel, pixelAt(p));
      pixel = stepped(pixel);
      good += goodEnough(example, ladderSegments(step) + 1, options.tolerancePx * pixel,
                         options.longestPx * pixel);
    }
    if (double(good) >= kEnough * double(lock.examples.size())) return ladderSegments(step) + 1;
  }
  return most;
}

/// Samples of a lock's strands, and the parameters at which its columns are sampled for them.
struct LockSamples {
  std::uint32_t samples = 0;  ///< 0: it is not drawn
  std::vector<float> parameters;
};

std::vector<float> lockParameters(const HairModel& model, std::size_t l, const DetailOptions& options,
                                  const PixelSize& pixelAt) {
  const Lock& lock = model.locks[l];
  const HairModel::Members& members = model.members[l];
  if (!options.lod || model.styled) {  // frames follow the whole curve
    const std::vector<double> even = evenParameters(lock.height, model.fullPoints());
    return {even.begin(), even.end()};
  }
  const double pixel = smallestPixel(model, lock, pixelAt);
  return simplified(fineColumns(model, lock, members.maxLift), options.tolerancePx * pixel,
                    options.longestPx * pixel);
}

LockSamples lockSamples(const HairModel& model, std::size_t l, const DetailOptions& options,
                        const PixelSize& pixelAt) {
  const HairModel::Members& members = model.members[l];
  if (members.ranks.empty() || !members.finite) return {};
  if (!model.synthesised) return {importedSamples(members, options, pixelAt), {}};
  LockSamples out{0, lockParameters(model, l, options, pixelAt)};
  out.samples =
      model.styled ? importedSamples(members, options, pixelAt) : std::uint32_t(out.parameters.size());
  return out;
}

/// Mean diameter in pixels of the strands.
double meanWidthPx(const HairModel& model, const PixelSize& pixelAt) {
  double sum = 0;
  std::size_t looked = 0;
  const std::size_t count = model.coarse.strandCount();
  for (std::size_t s = 0; s < count; s += std::max<std::size_t>(count / 512, 1)) {
    const auto strand = model.coarse.strand(s);
    const CoarseStrands::Point& middle = strand[strand.size() / 2];
    sum += middle.width / model.coarse.scale / pixelAt(middle.position.cast<double>());
    ++looked;
  }
  return looked > 0 ? sum / double(looked) : 0;
}

/// Diameter in pixels that hardly a point exceeds, before widening.
double greatestWidthPx(const HairModel& model, const PixelSize& pixelAt) {
  constexpr double kHardly = 0.002;
  const auto& points = model.coarse.points;
  std::vector<double> widths;
  for (std::size_t p = 0; p < points.size(); p += std::max<std::size_t>(points.size() / 8192, 1))
    widths.push_back(points[p].width / model.coarse.scale / pixelAt(points[p].position.cast<double>()));
  if (widths.empty()) return 0;
  const auto nth = widths.end() - 1 - std::ptrdiff_t(kHardly * double(widths.size()));
  std::nth_element(widths.begin(), nth, widths.end());
  return *nth;
}

std::size_t prefixLength(const HairModel& model, double meanSegments, const DetailOptions& options,
                         const PixelSize& pixelAt) {
  const double count = double(model.strands);
  const std::size_t most = model.styled ? model.styledStrands : model.strands;
  if (!options.lod) return most;
  if (options.fraction > 0)
    return std::size_t(std::clamp(std::round(options.fraction * count), 1.0, double(most)));
  const double bound = std::min(double(options.maxSegments) / std::max(meanSegments, 1.0), double(most));
  const double wanted =
      std::max(count * meanWidthPx(model, pixelAt) / options.ribbonPx, double(options.leastStrands));
  const double share = std::min(wanted, bound) / std::max(count, 1.0);
  if (share >= 1) return model.strands;
  const double least = std::min(double(options.leastStrands), bound);
  return std::size_t(std::clamp(std::max(count * stepped(share), least), 1.0, double(most)));
}

/// Adds `count` strands of a lock to the plan, cut where a batch is full.
void addLock(std::uint32_t lock, std::size_t count, const LockSamples& of, std::size_t columns,
             std::size_t batchPoints, DetailPlan& plan) {
  const std::uint32_t samples = of.samples;
  const std::size_t parameters = of.parameters.size();
  std::size_t parameterStart = plan.parameters.size();
  if (parameterStart >= parameters && std::equal(of.parameters.begin(), of.parameters.end(),
                                                 plan.parameters.end() - std::ptrdiff_t(parameters))) {
    parameterStart -= parameters;
  } else {
    plan.parameters.insert(plan.parameters.end(), of.parameters.begin(), of.parameters.end());
  }
  for (std::size_t first = 0; first < count;) {
    if (plan.batches.empty() || plan.batches.back().points + samples > batchPoints) {
      plan.batches.push_back({std::uint32_t(plan.shares.size()), 0, 0, 0});
    }
    Batch& batch = plan.batches.back();
    const std::size_t room =
        std::max<std::size_t>((batchPoints - std::min<std::size_t>(batch.points, batchPoints)) / samples, 1);
    const std::uint32_t taken = std::uint32_t(std::min(room, count - first));
    plan.shares.push_back({lock, std::uint32_t(first), taken, samples, batch.points, batch.strands,
                           std::uint32_t(parameterStart), std::uint32_t(plan.columns)});
    plan.columns += columns;
    ++batch.shares;
    batch.points += taken * samples;
    batch.strands += taken;
    plan.strands += taken;
    plan.points += std::size_t(taken) * samples;
    first += taken;
  }
}

}  // namespace

std::uint32_t ladderSegments(std::uint32_t step) {
  if (step == 0) return 1;
  return step % 2 == 1 ? 2u << (step / 2) : 3u << (step / 2 - 1);
}

std::uint32_t ladderStep(std::uint32_t segments) {
  std::uint32_t step = 0;
  while (step < 60 && ladderSegments(step) < segments) ++step;
  return step;
}

DetailPlan makePlan(const HairModel& model, const DetailOptions& options, const PixelSize& pixelAt,
                    const Context& context) {
  DetailPlan plan;
  std::vector<LockSamples> locks(model.locks.size());
  parallelFor(context, locks.size(), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t l = begin; l < end; ++l) locks[l] = lockSamples(model, l, options, pixelAt);
  });
  double segments = 0;
  for (std::size_t l = 0; l < locks.size(); ++l) {
    if (locks[l].samples > 0)
      segments += double(model.members[l].ranks.size()) * double(locks[l].samples - 1);
  }
  const std::size_t prefix =
      prefixLength(model, segments / std::max<double>(double(model.strands), 1), options, pixelAt);
  plan.widthScale = model.baseScale * (prefix > 0 ? double(model.strands) / double(prefix) : 1);
  const double greatest = plan.widthScale * greatestWidthPx(model, pixelAt);
  plan.lines = options.lines && greatest <= 1;
  plan.thin = greatest <= kThinPx;
  for (std::size_t l = 0; l < locks.size(); ++l) {
    if (locks[l].samples == 0) continue;
    const auto& ranks = model.members[l].ranks;
    const auto count =
        std::size_t(std::lower_bound(ranks.begin(), ranks.end(), std::uint32_t(prefix)) - ranks.begin());
    const std::size_t columns = model.locks[l].corners * locks[l].parameters.size() + (model.styled ? 1 : 0);
    addLock(std::uint32_t(l), count, locks[l], columns, options.batchPoints, plan);
  }
  return plan;
}

}  // namespace coif::preview
