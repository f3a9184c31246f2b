// What the light map costs beside the memory it has to move.
#include "bench/visibility_experiments.h"
#include "coif/base/parallel.h"
#include "coif/light/light_density_map.h"

namespace coif {
namespace {

constexpr std::size_t kSegments = 100000;

/// The first strands that make 100 000 segments.
StrandSet prefix(const StrandSet& hair) {
  StrandSet out;
  out.metersPerUnit = hair.metersPerUnit;
  std::size_t segments = 0;
  for (std::size_t s = 0; s < hair.strandCount() && segments < kSegments; ++s) {
    const auto points = hair.strand(s);
    out.points.insert(out.points.end(), points.begin(), points.end());
    for (std::uint64_t p = hair.offsets[s]; !hair.widths.empty() && p < hair.offsets[s + 1]; ++p) {
      out.widths.push_back(hair.widths[p]);
    }
    out.offsets.push_back(out.points.size());
    segments += points.size() - 1;
  }
  return out;
}

// Once over the grid and the points, reading and writing.
void touch(std::vector<float>& grid, std::vector<Vec3f>& points, const Context& context) {
  parallelFor(context, grid.size(), std::size_t(1) << 17, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) grid[i] += 1;
  });
  parallelFor(context, points.size(), std::size_t(1) << 13, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) points[i] += Vec3f::Ones();
  });
}

}  // namespace

void addLightMapFigures(const StrandSet& hair, const BenchOptions& options, BenchReport& report) {
  const StrandSet strands = prefix(hair);
  std::vector<Vec3> positions;
  for (const Vec3f& p : strands.points) positions.push_back(p.cast<double>());
  const LightView view = distantLightView(Vec3(-0.55, 0.65, 0.62), bounds(positions), 128);
  const FragmentStream stream = require(FragmentStream::make(strands, view, {}, options.context));
  std::vector<float> grid(std::size_t(1) << 21, 0.0f);
  std::vector<Vec3f> points = strands.points;
  LightDensityMap map = require(LightDensityMap::make(stream, {}, options.context));
  double fill[2], move[2];
  for (const int threads : {1, 2}) {
    Context context = options.context;
    context.threads = threads;
    // In turns, so that what else the machine does meets both alike; the fastest of eight.
    for (int i = 0; i < 8; ++i) {
      const double filling = fastestSeconds([&] {
        if (!map.update(stream, context).ok()) throw BenchFault{makeError(ErrorCode::Cancelled, "cancelled")};
      });
      const double moving = fastestSeconds([&] { touch(grid, points, context); });
      fill[threads - 1] = i == 0 ? filling : std::min(fill[threads - 1], filling);
      move[threads - 1] = i == 0 ? moving : std::min(move[threads - 1], moving);
    }
  }
  const Bar most = options.quick ? Bar::None : Bar::AtMost, least = options.quick ? Bar::None : Bar::AtLeast;
  report.figures.push_back(
      {"light map of 128\xc2\xb3 cells, 100 000 segments, one thread / reading and writing both once",
       fill[0] / move[0], "", most, 5});
  report.figures.push_back(
      {"the same on two threads / reading and writing on two threads", fill[1] / move[1], ""});
  report.figures.push_back(
      {"light map: one thread's time / two threads'", fill[0] / fill[1], "", least, 1.7});
  report.figures.push_back({"light map on one thread", 1e3 * fill[0], "ms"});
}

}  // namespace coif
