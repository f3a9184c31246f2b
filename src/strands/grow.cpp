#include "coif/strands/grow.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <new>
#include <stdexcept>

#include "coif/base/parallel.h"
#include "coif/strands/roots.h"
#include "coif/strands/sampler.h"

namespace coif {
namespace {

constexpr double kDefaultWidthMetres = 0.08e-3;
constexpr std::uint64_t kMostPoints = std::uint64_t{1} << 40;
constexpr std::size_t kErrorSamples = 32;  // strands whose chord error is measured

Error invalid(std::string message) {
  return makeError(ErrorCode::InvalidArgument, std::move(message));
}

Status checkOptions(const GrowOptions& options) {
  if (options.tolerance && !(*options.tolerance > 0)) return invalid("the tolerance must be above zero");
  if (!options.tolerance && options.points < 2) return invalid("a strand needs at least two points");
  if (!(options.width >= 0) || !(options.tipWidth >= 0) || !std::isfinite(options.width + options.tipWidth)) {
    return invalid("widths must be zero or more");
  }
  if (!(options.metersPerUnit > 0) || !std::isfinite(options.metersPerUnit)) {
    return invalid("the scene's unit must be a length above zero");
  }
  return {};
}

/// Refuses what is more than the machine has: asked for it bit by bit, it would swap for minutes and then end
/// the process without a word.
Status checkMemory(const GrowOptions& options) {
  constexpr double kStrandBytes = 84;  // of a root, its weights and what a StrandSet holds of each strand
  constexpr double kPointBytes = sizeof(Vec3f) + sizeof(float);
  constexpr double kGiB = 1 << 30;
  const double points = options.tolerance ? 2 : options.points;  // at least
  const double wanted = double(options.count) * (kStrandBytes + points * kPointBytes);
  const double there = double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGESIZE));
  if (!(there > 0) || wanted <= there) return {};
  char text[128];
  std::snprintf(text, sizeof text,
                "%zu strands do not fit into memory: they take %.0f GiB, and there are %.0f", options.count,
                wanted / kGiB, there / kGiB);
  return makeError(ErrorCode::TooLarge, text);
}

/// Where strands start on the head, and the texture there.
struct Landing {
  std::vector<Vec3f> points;
  std::vector<Vec2f> uvs;  // empty when the head has none
  double maxLift = 0;
};

Landing landOn(const Surface& head, const HairMesh& mesh, const RootSet& roots, const Context& context) {
  constexpr std::size_t kGrain = 512;
  Landing landing;
  landing.points.resize(roots.size());
  landing.uvs.resize(head.mesh().cornerUvs.empty() ? 0 : roots.size());
  std::vector<double> lifts((roots.size() + kGrain - 1) / kGrain, 0.0);
  parallelFor(context, roots.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t r = roots.byBundle[i];  // bundle by bundle: near queries follow each other
      const SurfacePoint foot = head.nearest(cagePoint(mesh, roots, r));
      landing.points[r] = foot.position.cast<float>();
      lifts[begin / kGrain] = std::max(lifts[begin / kGrain], foot.distance);
      Vec2 uv = Vec2::Zero();
      if (!landing.uvs.empty()) {
        head.uv(foot, uv);
        landing.uvs[r] = uv.cast<float>();
      }
    }
  });
  for (const double lift : lifts) landing.maxLift = std::max(landing.maxLift, lift);
  return landing;
}

void fillPoints(const StrandSampler& sampler, const GrowOptions& options, StrandSet& out,
                const Context& context) {
  out.offsets.assign(sampler.offsets().begin(), sampler.offsets().end());
  out.points.resize(sampler.pointCount());
  out.widths.resize(sampler.pointCount());
  const double width = options.width > 0 ? options.width : kDefaultWidthMetres / options.metersPerUnit;
  sampler.evaluate(out.points, out.widths, float(width), float(width * options.tipWidth), context);
}

void fillStrands(const HairMesh& mesh, RootSet& roots, StrandSet& out) {
  const std::size_t count = roots.size();
  out.rootFaces.resize(count);
  out.groups.resize(count);
  for (std::size_t r = 0; r < count; ++r) {
    const Bundle& bundle = mesh.bundles()[roots.bundles[r]];
    out.rootFaces[r] = std::uint32_t(bundle.id);
    out.groups[r] = bundle.group;
  }
  out.groupNames.assign(mesh.groupNames().begin(), mesh.groupNames().end());
  out.ids = std::move(roots.ids);
  out.weightOffsets = std::move(roots.weightOffsets);
  out.weights = std::move(roots.weights);
}

double boxDiagonal(std::span<const Vec3f> points) {
  if (points.empty()) return 0;
  Vec3f lo = points[0], hi = points[0];
  for (const Vec3f& p : points) lo = lo.cwiseMin(p), hi = hi.cwiseMax(p);
  return double((hi - lo).norm());
}

Result<GrowResult> growWhole(const HairMesh& mesh, const GrowOptions& options, const Context& context) {
  const Stopwatch watch;
  COIF_TRY(checkOptions(options));
  COIF_TRY(checkMemory(options));
  context.report("placing roots", 0);
  COIF_ASSIGN(RootSet roots, placeRoots(mesh, {options.count, options.seed, options.density}, context));
  GrowResult result;
  StrandSet& strands = result.strands;
  strands.metersPerUnit = options.metersPerUnit;
  strands.upAxis = options.upAxis;
  GrowReport& report = result.report;
  report.negativeWeights = roots.negativeWeights;
  report.triangulatedFaces = roots.triangulatedFaces;
  report.barrenBundles = roots.barrenBundles;
  report.zeroLength = roots.zeroLength;
  {
    context.report("landing roots on the head", 0.2);
    Landing landing;
    if (options.head != nullptr) landing = landOn(*options.head, mesh, roots, context);
    report.maxRootLift = landing.maxLift;
    strands.rootUvs = std::move(landing.uvs);
    context.report("sampling strands", 0.5);
    const StrandSampler sampler(mesh, roots, {options.points, options.tolerance, options.knots},
                                landing.points, context);
    if (sampler.pointCount() > kMostPoints) {
      return makeError(ErrorCode::TooLarge, std::to_string(sampler.pointCount()) + " points are too many");
    }
    fillPoints(sampler, options, strands, context);
    if (context.cancelled()) return makeError(ErrorCode::Cancelled, "stopped while growing strands");
    const double size = boxDiagonal(strands.points);
    report.error = {size > 0 ? sampler.chordError(strands.points, kErrorSamples) / size : 0,
                    "of the bounding box",
                    "spline at 16 times the points on " +
                        std::to_string(std::min(kErrorSamples, roots.size())) + " strands"};
  }
  fillStrands(mesh, roots, strands);
  report.seconds = watch.seconds();
  context.report("sampling strands", 1);
  return result;
}

}  // namespace

Result<GrowResult> grow(const HairMesh& mesh, const GrowOptions& options, const Context& context) {
  try {
    return growWhole(mesh, options, context);
  } catch (const std::bad_alloc&) {
  } catch (const std::length_error&) {
  }
  return makeError(ErrorCode::TooLarge, std::to_string(options.count) + " strands do not fit into memory");
}

}  // namespace coif
