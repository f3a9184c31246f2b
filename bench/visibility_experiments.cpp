#include "bench/visibility_experiments.h"

#include <cmath>

#include "bench/bench_text.h"
#include "coif/base/random.h"
#include "coif/light/visibility.h"

namespace coif {
namespace {

/// Many lines of sight at once: the texels of a map on [0, 1]², each with its own depths in [0, 1].
class SightLines {
 public:
  explicit SightLines(int side) {
    view_.eye = Vec3(0.5, 0.5, 1);
    view_.texel = 1.0 / side;
    view_.size = side;
  }
  int count() const { return view_.size * view_.size; }
  /// A hair straight across the texel's middle.
  void add(int texel, double depth, double alpha) {
    const double h = view_.texel, x = texel % view_.size, y = (texel / view_.size + 0.5) * h;
    for (const double end : {0.01, 0.99}) {
      hair_.points.push_back(Vec3f(float((x + end) * h), float(y), float(1 - std::clamp(depth, 0.0, 1.0))));
      hair_.widths.push_back(float(alpha * h));
    }
    hair_.offsets.push_back(hair_.points.size());
  }
  Vec3 at(int texel, double depth) const {
    return Vec3((texel % view_.size + 0.5) * view_.texel, (texel / view_.size + 0.5) * view_.texel,
                1 - depth);
  }
  std::unique_ptr<VisibilityMap> build(const VisibilityOptions& options) const {
    const FragmentStream stream = require(FragmentStream::make(hair_, view_));
    return require(buildVisibility(stream, options));
  }

 private:
  StrandSet hair_;
  LightView view_;
};

constexpr int kDepths = 200;

double meanError(const SightLines& lines, const VisibilityMap& map, const VisibilityMap& truth) {
  double sum = 0;
  for (int t = 0; t < lines.count(); ++t) {
    for (int i = 0; i < kDepths; ++i) {
      const Vec3 p = lines.at(t, (i + 0.5) / kDepths);
      sum += std::abs(map.transmittance(p) - truth.transmittance(p));
    }
  }
  return sum / (kDepths * double(lines.count()));
}

VisibilityOptions choose(VisibilityMethod method) {
  VisibilityOptions options;
  options.method = method;
  return options;
}
VisibilityOptions clusters(int count) {
  VisibilityOptions options = choose(VisibilityMethod::DensityClustering);
  options.clusters = count;
  return options;
}
VisibilityOptions slices(int count) {
  VisibilityOptions options = choose(VisibilityMethod::Opacity);
  options.slices = count;
  return options;
}
VisibilityOptions layers(int count, LayerSizes law = LayerSizes::Linear, double size = 0) {
  VisibilityOptions options;
  options.layers = count;
  options.sizes = law;
  options.layerSize = size;
  return options;
}

double gaussian(const CounterRandom& random, std::uint64_t i) {
  return std::sqrt(-2 * std::log(1 - random.uniform(2 * i))) *
         std::cos(6.283185307179586 * random.uniform(2 * i + 1));
}

void addCurve(BenchPlot& plot, const std::string& called, const SightLines& lines, int texel,
              const VisibilityMap& map) {
  for (int i = 0; i <= kDepths; ++i) {
    const double depth = double(i) / kDepths;
    BenchSample sample{called, {}, map.transmittance(lines.at(texel, depth)), 0, 0};
    sample.measures = {{"depth", depth}};
    plot.samples.push_back(std::move(sample));
  }
}

BenchPlot curves(const std::string& name, const std::string& title) {
  BenchPlot plot;
  plot.name = name;
  plot.title = title;
  plot.errorUnit = "transmittance";
  plot.truth = "the sorted list, drawn as a curve of its own";
  plot.against = "depth";
  plot.curves = true;
  return plot;
}

/// 256 lines of sight of 100 fragments, each from its own mixture of `modes` gaussians.
SightLines mixtures(int modes, std::uint64_t seed) {
  SightLines lines(16);
  for (int t = 0; t < lines.count(); ++t) {
    const CounterRandom random(seed, std::uint64_t(t * 16 + modes));
    const CounterRandom means = random.child(1), draws = random.child(2), picks = random.child(3);
    for (std::uint64_t i = 0; i < 100; ++i) {
      const std::uint32_t mode = picks.below(i, std::uint32_t(modes));
      const double mean = 0.05 + 0.9 * means.uniform(2 * mode),
                   deviation = 0.002 + 0.05 * means.uniform(2 * mode + 1);
      lines.add(t, mean + deviation * gaussian(draws, i), 0.04);
    }
  }
  return lines;
}

void addMixtures(const BenchOptions& options, BenchReport& report) {
  for (const int modes : {4, 8}) {
    const std::string called = std::to_string(modes) + " gaussians";
    const SightLines lines = mixtures(modes, options.seed);
    const auto truth = lines.build(choose(VisibilityMethod::Exact));
    BenchPlot plot;
    plot.name = "visibility-mixture-" + std::to_string(modes);
    plot.title = "Depths from " + called + ": K clusters, 2K uniform bins";
    plot.errorUnit = "mean |\xce\x94T| over depth";
    plot.truth = "the sorted list; 256 lines of sight of 100 fragments";
    plot.against = "bytes a texel";
    for (const int k : {1, 2, 4, 8, 16}) {
      const auto clustered = lines.build(clusters(k)), uniform = lines.build(slices(2 * k));
      for (const auto& [method, map] :
           {std::pair{"K clusters", clustered.get()}, {"2K uniform bins", uniform.get()}}) {
        BenchSample sample{method, {{"K", std::to_string(k)}}, meanError(lines, *map, *truth), 0, 0};
        sample.measures = {{"bytes a texel", map->bytesPerTexel()}};
        plot.samples.push_back(std::move(sample));
      }
      if (k != 4) continue;
      report.figures.push_back({called + ": error of 8 uniform bins / of 4 clusters",
                                meanError(lines, *uniform, *truth) / meanError(lines, *clustered, *truth),
                                ""});
      BenchPlot example = curves("visibility-mixture-" + std::to_string(modes) + "-curve",
                                 "One line of sight through " + called);
      addCurve(example, "sorted list", lines, 0, *truth);
      addCurve(example, "4 clusters", lines, 0, *clustered);
      addCurve(example, "8 uniform bins", lines, 0, *uniform);
      report.plots.push_back(std::move(example));
    }
    report.plots.push_back(std::move(plot));
  }
}

/// A dense clump and a thinner one behind it; on every eighth line a stray hair far in front.
SightLines clumpsWithStrays(std::uint64_t seed) {
  SightLines lines(16);
  for (int t = 0; t < lines.count(); ++t) {
    const CounterRandom random(seed, std::uint64_t(1000 + t));
    if (t % 8 == 0) lines.add(t, 0.02, 0.05);
    for (std::uint64_t i = 0; i < 80; ++i) lines.add(t, 0.42 + 0.03 * gaussian(random, i), 0.05);
    for (std::uint64_t i = 80; i < 120; ++i) lines.add(t, 0.75 + 0.04 * gaussian(random, i), 0.05);
  }
  return lines;
}

void addStrayHair(const BenchOptions& options, BenchReport& report) {
  const SightLines lines = clumpsWithStrays(options.seed);
  const auto truth = lines.build(choose(VisibilityMethod::Exact));
  BenchPlot plot = curves("visibility-stray-hair", "A stray hair far in front of a clump");
  addCurve(plot, "sorted list", lines, 0, *truth);
  const std::pair<const char*, VisibilityOptions> methods[] = {
      {"deep opacity, 3 layers", layers(3)},
      {"deep opacity, 7 layers", layers(7)},
      {"occupancy 128/4", choose(VisibilityMethod::Occupancy)},
      {"4 clusters", clusters(4)},
      {"opacity, 16 slices", slices(16)}};
  for (const auto& [called, chosen] : methods) {
    const auto map = lines.build(chosen);
    addCurve(plot, called, lines, 0, *map);
    double worst = 0;
    for (int i = 0; i < kDepths; ++i) {
      const Vec3 p = lines.at(0, double(i) / kDepths);
      worst = std::max(worst, std::abs(map->transmittance(p) - truth->transmittance(p)));
    }
    report.figures.push_back({std::string("stray hair: greatest error of ") + called, worst, ""});
  }
  report.plots.push_back(std::move(plot));
}

/// Three to six tight clumps a line of sight.
SightLines clusteredStrands(std::uint64_t seed) {
  SightLines lines(16);
  for (int t = 0; t < lines.count(); ++t) {
    const CounterRandom random(seed, std::uint64_t(2000 + t)), draws = random.child(1);
    std::uint64_t drawn = 0;
    for (std::uint64_t clump = 0, count = 3 + random.below(0, 4); clump < count; ++clump) {
      const double mean = 0.05 + 0.9 * random.uniform(1 + 2 * clump),
                   deviation = 0.01 + 0.015 * random.uniform(2 + 2 * clump);
      for (int i = 0; i < 30; ++i) lines.add(t, mean + deviation * gaussian(draws, drawn++), 0.03);
    }
  }
  return lines;
}

void addLayerSizes(const BenchOptions& options, BenchReport& report) {
  const SightLines lines = clusteredStrands(options.seed);
  const auto truth = lines.build(choose(VisibilityMethod::Exact));
  for (const int count : {3, 7}) {
    BenchPlot plot = curves("visibility-layer-sizes-" + std::to_string(count),
                            std::to_string(count) + " deep opacity layers on clustered strands");
    plot.errorUnit = "mean |\xce\x94T| over depth";
    plot.truth = "the sorted list; 256 lines of sight through three to six clumps";
    plot.against = "end of the last layer, of the hair's depth";
    for (const LayerSizes law :
         {LayerSizes::Constant, LayerSizes::Linear, LayerSizes::PowersOfTwo, LayerSizes::Fibonacci}) {
      const double unit = deepLayerEnds(law, count, 1).back();
      for (int i = 1; i <= 24; ++i) {
        const double end = 0.05 * i;
        BenchSample sample{
            name(law), {}, meanError(lines, *lines.build(layers(count, law, end / unit)), *truth), 0, 0};
        sample.measures = {{plot.against, end}};
        plot.samples.push_back(std::move(sample));
      }
    }
    const auto best =
        std::ranges::min_element(plot.samples, {}, [](const BenchSample& s) { return s.error; });
    report.figures.push_back(
        {std::to_string(count) + " layers on clustered strands: least error, law " + best->method,
         best->error, "mean |\xce\x94T|"});
    report.plots.push_back(std::move(plot));
  }
}

}  // namespace

void addPaperExperiments(const BenchOptions& options, BenchReport& report) {
  addMixtures(options, report);
  addStrayHair(options, report);
  addLayerSizes(options, report);
}

}  // namespace coif
