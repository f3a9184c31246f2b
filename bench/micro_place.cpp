// bench_place: one solve, by solver, root size and kind of mesh.
#include <benchmark/benchmark.h>

#include "bench/place_problem.h"
#include "coif/place/place.h"

namespace {

void solve(benchmark::State& state) {
  const auto side = std::uint32_t(state.range(1));
  const coif::HairMesh start = coif::placeProblemMesh({side, side / 2, coif::PlaceKind(state.range(2))}, 1);
  for (auto _ : state) {
    coif::HairMesh mesh = start;
    const auto report = coif::place(mesh, {coif::PlaceSolver(state.range(0)), 1e-9});
    if (!report.ok()) return state.SkipWithError(report.error().text().c_str());
    benchmark::DoNotOptimize(mesh);
    state.counters["iterations"] = report->iterations;
  }
}

}  // namespace

BENCHMARK(solve)
    ->ArgNames({"solver", "side", "kind"})
    ->ArgsProduct({benchmark::CreateDenseRange(0, int(coif::PlaceSolver::Direct), 1), {10, 20}, {0, 1, 2}})
    ->Unit(benchmark::kMillisecond);
