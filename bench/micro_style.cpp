// Styling 100 000 strands of 32 points against growing them, on all cores. Counters: `plan` and `apply` are
// the times of StylePlan's two halves over that of grow(); a kind of "none" is a stack whose one operator has
// the amount 0, "idle" the same made to run all the same: what leaving it out saves.
#include <benchmark/benchmark.h>

#include "bench/bench.h"
#include "bench/place_problem.h"
#include "coif/strands/grow.h"
#include "coif/style/style_kinds.h"
#include "coif/style/style_plan.h"

namespace {

using namespace coif;

constexpr std::size_t kStrands = 100000;

void style(benchmark::State& state, const StyleStack& stack, bool runIdle) {
  static const HairMesh kMesh = placeProblemMesh({14, 6, PlaceKind::Uniform}, 1);  // about 200 root quads
  GrowOptions growing;
  growing.count = kStrands;
  const StrandSet strands = require(grow(kMesh, growing)).strands;
  StyleOptions options;
  options.runIdle = runIdle;
  StylePlan plan;
  const auto planning = [&] { plan = require(StylePlan::create(kMesh, strands, stack, options)); };
  for ([[maybe_unused]] auto _ : state) planning();
  const double grown = fastestSeconds([&] { benchmark::DoNotOptimize(grow(kMesh, growing)); });
  StrandSet styled = strands;  // styled again and again: as long as styling it once
  state.counters["plan"] = fastestSeconds(planning) / grown;
  state.counters["apply"] = fastestSeconds([&] {
                              if (const Status done = plan.apply(kMesh, styled); !done.ok()) std::abort();
                            }) /
                            grown;
}

const int kRegistered = [] {
  for (const StyleKind& kind : styleKinds()) {
    if (kind.needsHead) continue;
    const StyleStack stack{makeStyleOperator(kind.name).value()};
    benchmark::RegisterBenchmark(kind.name.c_str(), style, stack, false)->Iterations(1);
  }
  StyleStack none{makeStyleOperator("curl").value()};
  none[0].amount = 0;
  benchmark::RegisterBenchmark("none", style, none, false)->Iterations(1);
  benchmark::RegisterBenchmark("idle", style, none, true)->Iterations(1);
  return 0;
}();

}  // namespace
