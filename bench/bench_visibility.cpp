// Shadows inside hair: every method and number of layers against the sorted lists, on three heads of hair.
#include <algorithm>
#include <cmath>

#include "bench/bench.h"
#include "bench/bench_text.h"
#include "bench/visibility_experiments.h"
#include "bench/visibility_models.h"
#include "coif/base/random.h"
#include "coif/light/image_metrics.h"
#include "coif/light/visibility.h"

namespace coif {
namespace {

const Vec3 kToLight(-0.55, 0.65, 0.62);

struct Case {
  std::string method, choice;
  VisibilityOptions options;
};

std::vector<Case> cases(bool quick) {
  std::vector<Case> out;
  const auto add = [&](const char* method, const std::string& choice, const VisibilityOptions& options) {
    out.push_back({method, choice, options});
  };
  VisibilityOptions o;
  o.method = VisibilityMethod::Opacity;
  for (const int slices : quick ? std::vector{16, 128} : std::vector{8, 16, 32, 64, 128, 256}) {
    o.slices = slices;
    add("opacity slices", std::to_string(slices), o);
  }
  o.method = VisibilityMethod::DensityClustering;
  for (const int clusters : quick ? std::vector{4} : std::vector{2, 4, 8}) {
    o.clusters = clusters;
    add("density clusters", std::to_string(clusters), o);
  }
  o.method = VisibilityMethod::DeepOpacity;
  for (const LayerSizes law :
       {LayerSizes::Linear, LayerSizes::Constant, LayerSizes::PowersOfTwo, LayerSizes::Fibonacci}) {
    o.sizes = law;
    for (const int layers : {3, 7, 11, 15}) {
      if ((quick || law != LayerSizes::Linear) && layers != 7) continue;
      o.layers = layers;
      add(law == LayerSizes::Linear ? "deep opacity layers" : "deep opacity, other laws",
          std::to_string(layers) + (law == LayerSizes::Linear ? "" : std::string(" ") + name(law)), o);
    }
  }
  o.sizes = LayerSizes::Linear, o.layers = 7;
  for (const PastLastLayer past : {PastLastLayer::Ignore, PastLastLayer::EnlargeLast}) {
    o.past = past;
    add("deep opacity, other ends", std::string("7 ") + name(past), o);
  }
  o.past = PastLastLayer::AddToLast, o.layers = 0;
  add("deep opacity, automatic", "auto", o);
  o.method = VisibilityMethod::Occupancy;
  add("occupancy", "128/4", o);
  if (!quick) {
    o.occupancySlices = 256, o.slabs = 8;
    add("occupancy", "256/8", o);
  }
  o.method = VisibilityMethod::LightMap;
  for (const int log2 : quick ? std::vector{6} : std::vector{6, 7, 8}) {
    o.gridLog2Size = log2;
    add("light map", std::to_string(1 << log2), o);
  }
  return out;
}

/// One model under one light: the truth and the places where it is asked.
struct Setting {
  const HairModel* model = nullptr;
  LightView view;
  OpaqueMap head;
  std::unique_ptr<FragmentStream> stream;
  std::unique_ptr<VisibilityMap> truth;
  std::vector<SeenPoint> seen;
  int pixels = 0;  ///< a side of the camera's picture
  std::vector<Vec3> uniform, first;
};

Vec3 unproject(const LightView& view, double x, double y, double depth) {
  const double half = 0.5 * view.size, texel = view.texelAt(depth);
  return view.eye + (x - half) * texel * view.right + (y - half) * texel * view.up + depth * view.forward;
}

void light(Setting& s, const Vec3& shiftTexels, const BenchOptions& options) {
  const int size = suggestedMapSize(s.model->strands, s.model->box, options.quick ? 128 : 512);
  s.view = distantLightView(kToLight, s.model->box, size);
  s.view.eye += s.view.texel * (shiftTexels.x() * s.view.right + shiftTexels.y() * s.view.up);
  s.head = require(OpaqueMap::make(s.model->head, s.view, options.context));
  s.stream = std::make_unique<FragmentStream>(
      require(FragmentStream::make(s.model->strands, s.view, {}, options.context)));
}

// Uniform in the depth of a texel's hair, and the first hair itself, on a part of the texels.
void addDepths(Setting& s, const BenchOptions& options) {
  std::vector<float> near(s.stream->texelCount(), HUGE_VALF), far(s.stream->texelCount(), -HUGE_VALF);
  s.stream->forEach(options.context, [&](const Fragment& f) {
    near[f.texel] = std::min(near[f.texel], f.depth);
    far[f.texel] = std::max(far[f.texel], f.depth);
  });
  const std::size_t every = options.quick ? 1 : 4;
  for (std::size_t t = 0; t < near.size(); t += every) {
    if (!(near[t] <= far[t])) continue;
    const double x = double(t % std::size_t(s.view.size)) + 0.5,
                 y = double(t / std::size_t(s.view.size)) + 0.5;
    const double u = CounterRandom(options.seed, t).uniform(7);
    s.uniform.push_back(unproject(s.view, x, y, double(near[t]) + u * (double(far[t]) - double(near[t]))));
    s.first.push_back(unproject(s.view, x, y, double(near[t])));
  }
}

VisibilityOptions withHead(VisibilityOptions options, const Setting& s) {
  options.opaque = &s.head;
  return options;
}

Setting prepare(const HairModel& model, const BenchOptions& options) {
  Setting s;
  s.model = &model;
  const Camera camera = frameBox(model.box, model.strands.upAxis, 30, 8);
  s.pixels = options.quick ? 128 : 256;
  s.seen = seenPoints(model, camera, s.pixels, options);
  light(s, Vec3::Zero(), options);
  addDepths(s, options);
  VisibilityOptions exact;
  exact.method = VisibilityMethod::Exact;
  s.truth = require(buildVisibility(*s.stream, withHead(exact, s), {}, options.context));
  return s;
}

struct Errors {
  double l1 = 0, l2 = 0, worst = 0;
};

Errors seenErrors(const Setting& s, const VisibilityMap& map) {
  Errors e;
  double weight = 0;
  for (const SeenPoint& p : s.seen) {
    const double d = std::abs(map.transmittance(p.world) - s.truth->transmittance(p.world));
    e.l1 += p.weight * d;
    e.l2 += p.weight * d * d;
    e.worst = std::max(e.worst, d);
    weight += p.weight;
  }
  if (weight > 0) e.l1 /= weight, e.l2 = std::sqrt(e.l2 / weight);
  return e;
}

/// White hair under this light alone, before black: what a shadow's error looks like.
FloatImage litPicture(const Setting& s, const VisibilityMap& map) {
  FloatImage image(s.pixels, s.pixels);
  for (const SeenPoint& p : s.seen) {
    float* pixel = &image.rgba[4 * p.pixel];
    for (int c = 0; c < 3; ++c) pixel[c] = float(p.weight * map.transmittance(p.world));
    pixel[3] = float(p.weight);
  }
  return image;
}

double meanDifference(const std::vector<Vec3>& points, const VisibilityMap& a, const VisibilityMap& b) {
  double sum = 0;
  for (const Vec3& p : points) sum += std::abs(a.transmittance(p) - b.transmittance(p));
  return points.empty() ? 0 : sum / double(points.size());
}

double seenDifference(const Setting& s, const VisibilityMap& a, const VisibilityMap& b) {
  double sum = 0, weight = 0;
  for (const SeenPoint& p : s.seen) {
    sum += p.weight * std::abs(a.transmittance(p.world) - b.transmittance(p.world));
    weight += p.weight;
  }
  return weight > 0 ? sum / weight : 0;
}

VisibilityOptions sized(VisibilityOptions options, const Setting& s, const BenchOptions& bench) {
  if (options.method == VisibilityMethod::DeepOpacity && options.layers > 0) {
    options.layerSize =
        chooseLayerSize(*s.stream, options.sizes, options.layers, options.past, bench.context).size;
  }
  return options;
}

BenchSample measure(const Case& c, const Setting& s, const Setting& moved, const BenchOptions& options) {
  // A layer's size is chosen once for a head of hair, not each frame; the automatic choice pays for itself.
  const VisibilityOptions chosen = sized(withHead(c.options, s), s, options);
  std::unique_ptr<VisibilityMap> map;
  BenchSample sample{c.method, {{"choice", c.choice}}, 0, 0, 0};
  sample.seconds =
      fastestSeconds([&] { map = require(buildVisibility(*s.stream, chosen, {}, options.context)); });
  if (c.options.layers == 0 && c.options.method == VisibilityMethod::DeepOpacity) {
    sample.parameters[0].second =
        "auto: " +
        (map->method() == VisibilityMethod::Exact ? "lists" : std::to_string(map->options().layers));
  }
  const Errors errors = seenErrors(s, *map);
  sample.error = errors.l1;
  double none = 0;
  const double looking = fastestSeconds([&] {
    for (const SeenPoint& p : s.seen) none += map->transmittance(p.world);
  });
  VisibilityOptions again = chosen;
  again.opaque = &moved.head;
  const auto other = require(buildVisibility(*moved.stream, again, {}, options.context));
  const TransmittanceBound bound = map->aPosterioriBound();
  const FloatImage picture = litPicture(s, *map), truth = litPicture(s, *s.truth);
  sample.measures = {
      {"bytes a texel", map->bytesPerTexel()},
      {"L2", errors.l2},
      {"max", errors.worst},
      {"relative MSE of the picture", require(relativeMse(picture, truth))},
      {"FLIP of the picture", require(flip(picture, truth)).mean},
      {"L1 over uniform depth", meanDifference(s.uniform, *map, *s.truth)},
      {"error at the first fragment", meanDifference(s.first, *map, *s.truth)},
      {"flicker", seenDifference(s, *map, *other)},
      {"a-posteriori bound, mean", bound.mean},
      {"nanoseconds a query", 1e9 * looking / double(std::max<std::size_t>(s.seen.size(), 1))}};
  if (!std::isfinite(none))
    throw BenchFault{makeError(ErrorCode::Degenerate, "a transmittance is not a number")};
  return sample;
}

// The same sum another way: over all fragments in double, for a part of the places.
double exactError(const Setting& s) {
  struct Query {
    float depth;
    double omega, found;
  };
  std::vector<std::vector<Query>> queries(s.stream->texelCount());
  const std::size_t step = std::max<std::size_t>(s.seen.size() / 3000, 1);
  for (std::size_t i = 0; i < s.seen.size(); i += step) {
    const Vec3 p = s.view.project(s.seen[i].world);
    if (!(p.x() >= 0 && p.x() < s.view.size && p.y() >= 0 && p.y() < s.view.size)) continue;
    queries[std::size_t(p.y()) * std::size_t(s.view.size) + std::size_t(p.x())].push_back(
        {float(p.z()), 0, s.truth->opticalDepth(s.seen[i].world)});
  }
  for (int band = 0; band < s.stream->bandCount(); ++band) {
    s.stream->forBand(band, [&](const Fragment& f) {
      for (Query& q : queries[f.texel]) q.omega += f.depth < q.depth ? -std::log1p(-double(f.alpha)) : 0.0;
    });
  }
  double sum = 0, count = 0;
  for (const auto& texel : queries) {
    for (const Query& q : texel) sum += std::abs(std::exp(-q.omega) - std::exp(-q.found)), ++count;
  }
  return count > 0 ? sum / count : 0;
}

const BenchSample* find(const BenchPlot& plot, const std::string& method, const std::string& choice) {
  for (const BenchSample& s : plot.samples) {
    if (s.method == method && s.parameters[0].second.starts_with(choice)) return &s;
  }
  return nullptr;
}

void addFigures(const HairModel& model, const BenchPlot& plot, const Setting& s, const Setting& moved,
                const BenchOptions& options, BenchReport& report) {
  const auto error = [&](const std::string& method, const std::string& choice) {
    return find(plot, method, choice)->error;
  };
  report.figures.push_back({model.name + ": L1 of seven deep opacity layers",
                            error("deep opacity layers", "7"), "", Bar::AtMost, 0.05});
  report.figures.push_back(
      {model.name + ": L1 of occupancy 128/4", error("occupancy", "128"), "", Bar::AtMost, 0.03});
  report.figures.push_back({model.name + ": L1 of the automatic layers",
                            error("deep opacity, automatic", "auto"), "", Bar::AtMost, 0.02});
  report.figures.push_back(
      {model.name + ": L1 of the sorted list against plain sums", exactError(s), "", Bar::AtMost, 1e-6});
  VisibilityOptions none, exact;
  none.method = VisibilityMethod::None;
  exact.method = VisibilityMethod::Exact;
  const auto unshadowed = require(buildVisibility(*s.stream, withHead(none, s), {}, options.context));
  report.figures.push_back(
      {model.name + ": L1 without shadows in the hair", seenErrors(s, *unshadowed).l1, ""});
  exact.opaque = &moved.head;
  const auto shifted = require(buildVisibility(*moved.stream, exact, {}, options.context));
  report.figures.push_back(
      {model.name + ": flicker of the truth", seenDifference(s, *s.truth, *shifted), ""});
  std::unique_ptr<VisibilityMap> again;
  const double seconds = fastestSeconds(
      [&] { again = require(buildVisibility(*s.stream, withHead(exact, s), {}, options.context)); });
  report.figures.push_back({model.name + ": time of the sorted lists / of seven deep opacity layers",
                            seconds / find(plot, "deep opacity layers", "7")->seconds, ""});
  report.figures.push_back({model.name + ": bytes a texel of the sorted lists", again->bytesPerTexel(), ""});
}

void measureModel(const HairModel& model, const BenchOptions& options, BenchReport& report) {
  const Setting setting = prepare(model, options);
  Setting moved;
  moved.model = &model;
  light(moved, Vec3(0.37, 0.21, 0), options);
  BenchPlot plot;
  std::string stem = model.name.substr(0, model.name.find(' '));
  plot.name = "visibility-" + stem;
  plot.title =
      "Shadow methods on the " + model.name + ", " + std::to_string(model.strands.strandCount()) + " strands";
  plot.errorUnit = "mean |\xce\x94T| at what the camera sees";
  plot.truth = "all fragments of a texel sorted by depth, on the same map of " +
               std::to_string(setting.view.size) + "\xc2\xb2";
  for (const Case& c : cases(options.quick)) plot.samples.push_back(measure(c, setting, moved, options));
  plot.rateAgainst("deep opacity layers", {{"choice", "7"}});
  addFigures(model, plot, setting, moved, options, report);
  BenchPlot bytes = plot;
  bytes.name += "-bytes";
  bytes.against = "bytes a texel";
  report.plots.push_back(std::move(plot));
  report.plots.push_back(std::move(bytes));
}

}  // namespace

BenchReport benchVisibility(const BenchOptions& options) {
  BenchReport report;
  report.title = "Shadows inside hair";
  report.about =
      "How much of a distant light reaches the hair that a camera sees, by every shadow method on one map of "
      "light "
      "fragments (a texel of ten hair's widths, 512 a side at most; quick: 128), with the head as an opaque "
      "shadow map beside it. The "
      "camera looks at "
      "azimuth 30 and elevation 8 degrees; each pixel gives one place on a hair, drawn by its visible share "
      "\xce\xb1 "
      "\xce\xa0(1 \xe2\x88\x92 \xce\xb1) among the pixel's sorted fragments and weighted by the pixel's "
      "coverage. Time "
      "is that of building the map from binned segments, without choosing the layers' size except for the "
      "automatic "
      "choice. The picture is white hair under that light alone. Flicker is the mean change of T when the "
      "light moves by 0.37 and 0.21 of a texel. Ratios are "
      "to seven "
      "linear deep opacity layers.";
  const std::vector<HairModel> models = hairModels(options);
  for (const HairModel& model : models) measureModel(model, options, report);
  addPaperExperiments(options, report);
  addLightMapFigures(models[0].strands, options, report);
  return report;
}

}  // namespace coif
