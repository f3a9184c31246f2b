// How fast strands go to USD, against one plain write of the same bytes through the same file class.
#include <benchmark/benchmark.h>

#include <filesystem>

#include "coif/base/random.h"
#include "coif/io/safe_file.h"
#include "coif/io/strand_io.h"

namespace {

using namespace coif;

constexpr std::size_t kPoints = 32;

StrandSet strandsFor(std::size_t count) {
  StrandSet set;
  const CounterRandom random(5);
  for (std::size_t s = 0; s < count; ++s) {
    for (std::size_t i = 0; i < kPoints; ++i) {
      const std::uint64_t c = 3 * (s * kPoints + i);
      set.points.emplace_back(float(random.uniform(c)), float(random.uniform(c + 1)), float(i));
      set.widths.push_back(0.008f);
    }
    set.offsets.push_back(set.points.size());
    set.ids.push_back(random.bits(s));
    set.rootUvs.emplace_back(float(random.uniform(s)), 0.5f);
  }
  return set;
}

std::filesystem::path fileNamed(const char* name) {
  return std::filesystem::temp_directory_path() / name;
}

void save(benchmark::State& state, const char* name) {
  const StrandSet strands = strandsFor(std::size_t(state.range(0)));
  StrandExport what;
  what.strands = &strands;
  std::int64_t bytes = 0;
  for (auto _ : state) {
    const auto report = saveStrands(what, fileNamed(name));
    if (!report) return state.SkipWithError(report.error().text().c_str());
    bytes += std::int64_t(report->bytes);
  }
  state.SetBytesProcessed(bytes);
  std::filesystem::remove(fileNamed(name));
}

void usdc(benchmark::State& state) {
  save(state, "coif_bench.usdc");
}
void usda(benchmark::State& state) {
  save(state, "coif_bench.usda");
}

void plainWrite(benchmark::State& state) {
  const StrandSet strands = strandsFor(std::size_t(state.range(0)));
  std::int64_t bytes = 0;
  for (auto _ : state) {
    auto file = SafeFile::create(fileNamed("coif_bench.bin"));
    if (!file) return state.SkipWithError(file.error().text().c_str());
    file->writeArray<Vec3f>(strands.points);
    file->writeArray<float>(strands.widths);
    file->writeArray<std::uint64_t>(strands.ids);
    file->writeArray<Vec2f>(strands.rootUvs);
    bytes += std::int64_t(file->position());
    if (const Status done = file->commit(); !done) return state.SkipWithError(done.error().text().c_str());
  }
  state.SetBytesProcessed(bytes);
  std::filesystem::remove(fileNamed("coif_bench.bin"));
}

void load(benchmark::State& state, const char* name) {
  const StrandSet strands = strandsFor(std::size_t(state.range(0)));
  StrandExport what;
  what.strands = &strands;
  const auto report = saveStrands(what, fileNamed(name));
  if (!report) return state.SkipWithError(report.error().text().c_str());
  for (auto _ : state) benchmark::DoNotOptimize(loadStrands(fileNamed(name)));
  state.SetBytesProcessed(std::int64_t(state.iterations()) * std::int64_t(report->bytes));
  std::filesystem::remove(fileNamed(name));
}

void readUsdc(benchmark::State& state) {
  load(state, "coif_bench_in.usdc");
}
void readUsda(benchmark::State& state) {
  load(state, "coif_bench_in.usda");
}

BENCHMARK(plainWrite)->Arg(100000)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(usdc)->Arg(100000)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(usda)->Arg(100000)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(readUsdc)->Arg(100000)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(readUsda)->Arg(100000)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();

}  // namespace
