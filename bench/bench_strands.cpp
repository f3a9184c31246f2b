// Sampling strands: points a strand and tolerances against the error they leave and the time they take.
#include <algorithm>
#include <cmath>

#include "bench/bench.h"
#include "bench/bench_growth.h"
#include "bench/bench_text.h"
#include "bench/place_problem.h"
#include "coif/base/parallel.h"
#include "coif/strands/hausdorff.h"
#include "coif/strands/roots.h"
#include "coif/strands/sampler.h"

namespace coif {
namespace {

constexpr std::size_t kTruthPoints = 4096;
constexpr std::size_t kTruthStrands = 64;

std::vector<Vec3> asDoubles(std::span<const Vec3f> points) {
  std::vector<Vec3> out;
  for (const Vec3f& p : points) out.push_back(p.cast<double>());
  return out;
}

double boxDiagonal(std::span<const Vec3f> points) {
  Vec3f lo = points[0], hi = points[0];
  for (const Vec3f& p : points) lo = lo.cwiseMin(p), hi = hi.cwiseMax(p);
  return double((hi - lo).norm());
}

/// The splines of a few strands at 4096 points, in double.
std::vector<std::vector<Vec3>> truths(const HairMesh& mesh, const RootSet& roots) {
  std::vector<std::vector<Vec3>> out;
  for (std::size_t r = 0; r < std::min(kTruthStrands, roots.size()); ++r) {
    const Bundle& bundle = mesh.bundles()[roots.bundles[r]];
    std::vector<Vec3> control(bundle.height() + 1, Vec3::Zero());
    for (std::uint32_t k = 0; k <= bundle.height(); ++k) {
      for (std::uint32_t i = 0; i < bundle.corners; ++i) {
        control[k] += double(roots.weightsOf(r)[i]) * mesh.position(bundle.face(k)[i]);
      }
    }
    out.push_back(catmullRom(control, kTruthPoints));
  }
  return out;
}

double hausdorffError(const StrandSampler& sampler, std::span<const Vec3f> points,
                      const std::vector<std::vector<Vec3>>& truth) {
  double worst = 0;
  for (std::size_t r = 0; r < truth.size(); ++r) {
    const auto begin = sampler.offsets()[r], end = sampler.offsets()[r + 1];
    worst = std::max(worst, hausdorff(truth[r], asDoubles(points.subspan(begin, end - begin))));
  }
  return worst;
}

BenchSample measure(const char* method, const std::string& choice, const StrandSampler& sampler,
                    const std::vector<std::vector<Vec3>>& truth, double size, const Context& context) {
  std::vector<Vec3f> points(sampler.pointCount());
  BenchSample sample{method, {{"choice", choice}, {"points", std::to_string(points.size())}}, 0, 0, 0};
  sample.seconds = fastestSeconds([&] { sampler.evaluate(points, context); });
  sample.error = hausdorffError(sampler, points, truth) / size;
  return sample;
}

}  // namespace

BenchReport benchStrands(const BenchOptions& options) {
  BenchReport report;
  report.title = "Sampling strands";
  report.about =
      "Strands over a root of 20 by 20 quads and 10 layers whose vertices are shaken. The error is the "
      "Hausdorff "
      "distance of 64 strands to their splines; the time is that of evaluating all strands into memory that "
      "is there "
      "already. Ratios in the data are to 32 points a strand.";
  // First, while the process is still small: what it frees stays counted.
  report.figures = growthFigures(options);
  const HairMesh mesh = placeProblemMesh({20, 10, PlaceKind::Uniform}, options.seed);
  const RootSet roots =
      require(placeRoots(mesh, {options.quick ? 2000u : 100000u, options.seed, {}}, options.context));
  const auto truth = truths(mesh, roots);
  const StrandSampler base(mesh, roots, {});
  std::vector<Vec3f> points(base.pointCount());
  base.evaluate(points, options.context);
  const double size = boxDiagonal(points);

  BenchPlot plot;
  plot.name = "strands-sampling";
  plot.title = "Points a strand and tolerances";
  plot.errorUnit = "Hausdorff distance, of the bounding box";
  plot.truth = "4096 points a strand in double";
  double previous = 0, order = 0;
  for (const std::uint32_t count : {4u, 8u, 16u, 32u, 64u, 128u, 256u}) {
    const StrandSampler sampler(mesh, roots, {.points = count});
    plot.samples.push_back(
        measure("points a strand", std::to_string(count), sampler, truth, size, options.context));
    order = previous > 0 ? std::log2(previous / plot.samples.back().error) : 0;
    previous = plot.samples.back().error;
  }
  const std::string baseChoice = "32";
  double worstBound = 0;
  for (const double tolerance : {1e-2, 1e-3, 1e-4, 1e-5}) {
    const StrandSampler sampler(mesh, roots, {.tolerance = tolerance * size}, {}, options.context);
    plot.samples.push_back(
        measure("tolerance", shortNumber(tolerance), sampler, truth, size, options.context));
    worstBound = std::max(worstBound, plot.samples.back().error / tolerance);
  }
  plot.rateAgainst("points a strand", {{"choice", baseChoice}, {"points", std::to_string(points.size())}});
  report.plots.push_back(std::move(plot));

  const double evaluate = fastestSeconds([&] { base.evaluate(points, options.context); });
  const double fill = fastestSeconds([&] {
    parallelFor(options.context, points.size(), 1 << 15, [&](std::size_t begin, std::size_t end) {
      std::fill(points.data() + begin, points.data() + end, Vec3f(1, 2, 3));
    });
  });
  report.figures.push_back({"error / tolerance, worst", worstBound, "", Bar::AtMost, 1});
  report.figures.push_back({"order of the error in the number of points", order, "", Bar::AtLeast, 1.8});
  report.figures.push_back({"evaluating 32 points a strand / filling the same memory", evaluate / fill, ""});
  return report;
}

}  // namespace coif
