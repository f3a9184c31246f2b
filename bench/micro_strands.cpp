// Growing 100 000 strands of 32 points against filling as much memory, on all cores. The counter `ratio` is
// the time over that of the fill.
#include <benchmark/benchmark.h>

#include <algorithm>

#include "bench/bench.h"
#include "bench/place_problem.h"
#include "coif/base/parallel.h"
#include "coif/strands/grow.h"
#include "coif/strands/sampler.h"

namespace {

using namespace coif;

constexpr std::size_t kStrands = 100000;

const HairMesh& mesh() {
  static const HairMesh kMesh = placeProblemMesh({14, 6, PlaceKind::Uniform}, 1);  // about 200 root quads
  return kMesh;
}

double fillSeconds(std::span<Vec3f> points) {
  return fastestSeconds([&] {
    parallelFor({}, points.size(), 1 << 15, [&](std::size_t begin, std::size_t end) {
      std::fill(points.data() + begin, points.data() + end, Vec3f(1, 2, 3));
    });
    benchmark::ClobberMemory();
  });
}

/// Points into memory that is there already, against filling it.
void evaluatePoints(benchmark::State& state) {
  const RootSet roots = require(placeRoots(mesh(), {kStrands, 1, {}}));
  const StrandSampler sampler(mesh(), roots, {});
  std::vector<Vec3f> points(sampler.pointCount());
  const double fill = fillSeconds(points);
  for ([[maybe_unused]] auto _ : state) sampler.evaluate(points);
  state.counters["ratio"] = fastestSeconds([&] { sampler.evaluate(points); }) / fill;
}
BENCHMARK(evaluatePoints)->Unit(benchmark::kMillisecond)->UseRealTime();

/// All of grow(), roots and widths included, against allocating and filling the points.
void growStrands(benchmark::State& state) {
  const GrowOptions options{.count = kStrands};
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(grow(mesh(), options));
  const double fill = fastestSeconds([&] {
    std::vector<Vec3f> points(kStrands * 32, Vec3f(1, 2, 3));
    benchmark::DoNotOptimize(points.data());
  });
  state.counters["ratio"] = fastestSeconds([&] { benchmark::DoNotOptimize(grow(mesh(), options)); }) / fill;
}
BENCHMARK(growStrands)->Unit(benchmark::kMillisecond)->UseRealTime();

void placeOneMillionRoots(benchmark::State& state) {
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(placeRoots(mesh(), {1000000, 1, {}}));
}
BENCHMARK(placeOneMillionRoots)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
