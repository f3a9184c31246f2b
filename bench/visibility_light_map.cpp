// What the light map costs beside the memory it has to move.
#include <cmath>
#include <cstring>

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

/// Memory to move, each once in and once out: the grid, the segments' points and their widths.
class Traffic {
 public:
  explicit Traffic(const StrandSet& strands) : points_(3 * strands.points.size()), widths_(strands.widths) {
    std::memcpy(points_.data(), strands.points.data(), points_.size() * sizeof(float));
  }
  void move(const Context& context) {
    for (std::vector<float>* values : {&grid_, &points_, &widths_}) {
      parallelFor(context, values->size(), std::size_t(1) << 17, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) (*values)[i] += 1;
      });
    }
  }

 private:
  std::vector<float> grid_ = std::vector<float>(std::size_t(1) << 21, 0.0f);
  std::vector<float> points_, widths_;
};

/// What lies between two pictures: other memory, four times what the nearest caches hold together.
class Caches {
 public:
  void displace() {
    for (std::size_t i = 0; i < memory_.size(); i += 16) memory_[i] += 1;
  }

 private:
  std::vector<float> memory_ = std::vector<float>(std::size_t(1) << 25, 0.0f);  // 128 MiB
};

template <class Call>
double seconds(const Call& call) {
  const Stopwatch watch;
  call();
  return watch.seconds();
}

struct Times {
  double fill[2] = {HUGE_VAL, HUGE_VAL}, move[2] = {HUGE_VAL, HUGE_VAL};  ///< by threads
  double ratio(int threads) const { return fill[threads - 1] / move[threads - 1]; }
};

// In turns, so that what else the machine does meets both alike; the fastest of each.
Times timed(LightDensityMap& map, const FragmentStream& stream, Traffic& traffic, Caches* caches,
            const BenchOptions& options) {
  Times out;
  const int repeats = options.quick ? 3 : 40;
  for (int i = 0; i < repeats; ++i) {
    for (const int threads : {1, 2}) {
      Context context = options.context;
      context.threads = threads;
      double &fill = out.fill[threads - 1], &move = out.move[threads - 1];
      if (caches != nullptr) caches->displace();
      fill = std::min(fill, seconds([&] {
                        if (!map.update(stream, context).ok()) {
                          throw BenchFault{makeError(ErrorCode::Cancelled, "cancelled")};
                        }
                      }));
      if (caches != nullptr) caches->displace();
      move = std::min(move, seconds([&] { traffic.move(context); }));
    }
  }
  return out;
}

}  // namespace

void addLightMapFigures(const StrandSet& hair, const BenchOptions& options, BenchReport& report) {
  const StrandSet strands = prefix(hair);
  std::vector<Vec3> positions;
  for (const Vec3f& p : strands.points) positions.push_back(p.cast<double>());
  const LightView view = distantLightView(Vec3(-0.55, 0.65, 0.62), bounds(positions), 128);
  const FragmentStream stream = require(FragmentStream::make(strands, view, {}, options.context));
  Traffic traffic(strands);
  Caches caches;
  LightDensityMap map = require(LightDensityMap::make(stream, {}, options.context));
  const Times far = timed(map, stream, traffic, &caches, options),
              near = timed(map, stream, traffic, nullptr, options);
  const Bar most = options.quick ? Bar::None : Bar::AtMost, least = options.quick ? Bar::None : Bar::AtLeast;
  const std::string what = "light map of 128\xc2\xb3 cells, 100 000 segments";
  report.figures.push_back(
      {what + ", one thread / reading and writing both once, from memory", far.ratio(1), "", most, 5});
  report.figures.push_back({"the same, grid and segments in the caches", near.ratio(1), ""});
  report.figures.push_back(
      {"the same on two threads / reading and writing on two threads, from memory", far.ratio(2), ""});
  report.figures.push_back({"light map: one thread's time / two threads', from memory",
                            far.fill[0] / far.fill[1], "", least, 1.7});
  report.figures.push_back(
      {"light map: one thread's time / two threads', in the caches", near.fill[0] / near.fill[1], ""});
  report.figures.push_back({"light map on one thread, from memory", 1e3 * far.fill[0], "ms"});
  report.figures.push_back({"light map on one thread, in the caches", 1e3 * near.fill[0], "ms"});
  report.figures.push_back({"reading and writing once, from memory", 1e3 * far.move[0], "ms"});
  report.figures.push_back({"reading and writing once, in the caches", 1e3 * near.move[0], "ms"});
}

}  // namespace coif
