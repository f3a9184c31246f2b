// Dual scattering against the path tracer: printed and corrected formulas, rays and maps, colours, light
// directions, widths and density factors.
#include <algorithm>
#include <cmath>
#include <memory>

#include "bench/bench.h"
#include "bench/bench_text.h"
#include "bench/scattering_scene.h"
#include "coif/base/report.h"
#include "coif/light/dual_render.h"
#include "coif/light/image_metrics.h"
#include "coif/light/path_tracer.h"

namespace coif {
namespace {

constexpr double kRelativeMseEpsilon = 0.01;  // relativeMse's own

struct Settings {
  int clusterSide, clusterSize, clusterSamples;
  std::size_t hairs;
  int bobSize, bobSamples, dualSamples;
  std::vector<HairColor> colors;
};

Settings settingsOf(const BenchOptions& options) {
  if (options.quick) {
    return {24, 24, 64, 4000, 32, 32, 16, {HairColor::Black, HairColor::Blond}};
  }
  return {64, 40,  512, 20000,
          80, 192, 32,  {HairColor::Black, HairColor::Brown, HairColor::Red, HairColor::Blond}};
}

FibreParameters fibreOf(HairColor color, double roughness = 0.3) {
  FibreParameters fibre;
  fibre.absorption = absorptionOf(color);
  fibre.longitudinalRoughness = roughness;
  return fibre;
}

PathTracePicture traced(const ScatteringScene& scene, const FibreParameters& fibre, int samples,
                        const BenchOptions& options) {
  PathTraceScene traced;
  traced.strands = &scene.strands;
  traced.head = scene.head.faceCount() > 0 ? &scene.head : nullptr;
  traced.headColor = Vec3f::Zero();
  traced.camera = scene.camera;
  traced.lights = scene.lights;
  traced.fibre = fibre;
  PathTraceOptions how;
  how.width = how.height = scene.size;
  how.samplesPerPixel = samples;
  how.seed = options.seed;
  return require(pathTrace(traced, how, options.context));
}

StrandShooter shooterOf(const ScatteringScene& scene) {
  return require(StrandShooter::create(scene.strands, scene.head.faceCount() > 0 ? &scene.head : nullptr));
}

/// The straight path to the light with density factors alone, or the hair around measured by as many rays.
struct Choice {
  std::string method;
  DualScatteringParameters dual;
  int surroundingRays = 0;
};

Choice choice(DualFormulas formulas, double density) {
  return {(formulas == DualFormulas::Printed ? "printed, density " : "corrected, density ") +
              shortNumber(density),
          {formulas, density, density},
          0};
}

Choice measured() {
  return {"corrected, measured", {DualFormulas::Corrected, 1, 1}, DualRenderOptions().surroundingRays};
}

/// How far a picture is from the truth, where there is hair.
struct Distance {
  double relMse = 0, flip = 0, colorRatio = 1;  ///< the channel's ratio of means that is farthest from 1
  std::vector<double> pixels;                   ///< relMse is their mean; of two pairs alone
};

/// The eye adapts: the truth's hair is shown at a mean of 0.3.
float exposureFor(const FloatImage& truth) {
  double brightness = 0, covered = 0;
  for (std::size_t i = 0; i < truth.rgba.size(); i += 4) {
    for (std::size_t c = 0; c < 3; ++c) brightness += double(truth.rgba[i + c]) / 3;
    covered += double(truth.rgba[i + 3]);
  }
  return float(0.3 * covered / std::max(1e-12, brightness));
}

Distance distanceTo(FloatImage picture, FloatImage truth) {
  Distance out;
  Vec3 mine = Vec3::Zero(), theirs = Vec3::Zero();
  for (std::size_t i = 0; i < truth.rgba.size(); ++i) {
    if (i % 4 < 3) mine[long(i % 4)] += double(picture.rgba[i]), theirs[long(i % 4)] += double(truth.rgba[i]);
  }
  for (int c = 0; c < 3; ++c) {
    const double ratio = mine[c] / std::max(1e-12, theirs[c]);
    if (std::abs(ratio - 1) > std::abs(out.colorRatio - 1)) out.colorRatio = ratio;
  }
  const float exposure = exposureFor(truth);
  for (float& v : picture.rgba) v *= exposure;
  for (float& v : truth.rgba) v *= exposure;
  out.relMse = require(relativeMse(picture, truth));
  out.flip = require(flip(picture, truth)).mean;
  return out;
}

/// Two pictures of one scene that share no random number.
struct Pair {
  FloatImage a, b;
  FloatImage mean() const {
    FloatImage out = a;
    for (std::size_t i = 0; i < out.rgba.size(); ++i) out.rgba[i] = 0.5f * (a.rgba[i] + b.rgba[i]);
    return out;
  }
};

/// The mean over the pixels around of each channel, squared. A single pixel of the truth that happened to
/// miss a rare light would divide what another picture met there by nearly nothing.
std::vector<double> squaresAround(const FloatImage& image) {
  constexpr int kReach = 3;
  std::vector<double> out(image.rgba.size());
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      Eigen::Array4d sum = Eigen::Array4d::Zero();
      int count = 0;
      for (int v = std::max(0, y - kReach); v <= std::min(image.height - 1, y + kReach); ++v) {
        for (int u = std::max(0, x - kReach); u <= std::min(image.width - 1, x + kReach); ++u, ++count) {
          sum += Eigen::Map<const Eigen::Array4f>(image.at(u, v)).cast<double>();
        }
      }
      const std::size_t at = 4 * (std::size_t(y) * std::size_t(image.width) + std::size_t(x));
      for (std::size_t c = 0; c < 4; ++c) out[at + c] = sum[long(c)] / count * (sum[long(c)] / count);
    }
  }
  return out;
}

/// FLIP and colour of the means; the relative MSE without anybody's noise: of four pictures that share
/// nothing, the product of two differences has the square of the true difference for its mean.
Distance distanceTo(const Pair& picture, const Pair& truth) {
  const FloatImage reference = truth.mean();
  Distance out = distanceTo(picture.mean(), reference);
  const double exposure = double(exposureFor(reference));
  const std::vector<double> around = squaresAround(reference);
  out.pixels.assign(reference.rgba.size() / 4, 0);
  for (std::size_t i = 0; i < reference.rgba.size(); ++i) {
    if (i % 4 == 3) continue;
    const auto at = [&](const FloatImage& image) { return exposure * double(image.rgba[i]); };
    const double t1 = at(truth.a), t2 = at(truth.b), p1 = at(picture.a), p2 = at(picture.b);
    const double squared = 0.5 * ((p1 - t1) * (p2 - t2) + (p1 - t2) * (p2 - t1));
    out.pixels[i / 4] += squared / (exposure * exposure * around[i] + kRelativeMseEpsilon) / 3;
  }
  out.relMse = 0;
  for (const double pixel : out.pixels) out.relMse += pixel / double(out.pixels.size());
  return out;
}

/// Half the 95 % interval of the difference of two means over the same pixels: pixels share no noise.
double differenceInterval(const std::vector<double>& a, const std::vector<double>& b) {
  const double n = double(a.size());
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] - b[i], squares += (a[i] - b[i]) * (a[i] - b[i]);
  return 1.96 * std::sqrt(std::max(0.0, squares / n - sum / n * (sum / n)) / n);
}

FloatImage dualPicture(const ScatteringScene& scene, const StrandShooter& shooter, const DualScattering& hair,
                       int samples, int surroundingRays, const BenchOptions& options,
                       std::span<const ForwardScatteringMap* const> maps = {}) {
  DualRenderOptions how;
  how.width = how.height = scene.size;
  how.samplesPerPixel = samples;
  how.seed = options.seed + 1;
  how.surroundingRays = surroundingRays;
  how.maps = maps;
  return require(renderDualScattering({&shooter, &hair, scene.camera, scene.lights}, how, options.context));
}

BenchSample sampleOf(const std::string& method, const std::string& scene, const std::string& chosen,
                     const Distance& distance, double seconds) {
  return {method,
          {{"case", scene},
           {"choice", chosen},
           {"FLIP", shortNumber(distance.flip)},
           {"colour ratio", shortNumber(distance.colorRatio)}},
          distance.relMse,
          seconds,
          0};
}

/// One truth, both formulas, several densities.
class Comparison {
 public:
  Comparison(const BenchOptions& options, int dualSamples) : options_(options), dualSamples_(dualSamples) {
    plot_.name = "scattering-formulas";
    plot_.title = "Dual scattering: printed and corrected formulas";
    plot_.errorUnit = "relative MSE to the path tracer";
    plot_.truth = "path traced with the same fibre; its own relative MSE is the method 'path traced'";
  }

  void run(const ScatteringScene& scene, const StrandShooter& shooter, const std::string& name,
           const FibreParameters& fibre, int samples, double colorBar) {
    BenchOptions other = options_;
    other.seed += 1000;
    const PathTracePicture first = traced(scene, fibre, samples / 2, options_);
    const Pair truth{first.image, traced(scene, fibre, samples / 2, other).image};
    noise(name, first);
    const FibreScattering scattering(fibre);
    std::vector<Distance> found;
    for (const Choice& how :
         {choice(DualFormulas::Printed, 0.7), choice(DualFormulas::Corrected, 0.7),
          choice(DualFormulas::Printed, 1), choice(DualFormulas::Corrected, 1), measured()}) {
      const DualScattering hair(scattering, how.dual);
      const Stopwatch watch;
      const int half = dualSamples_ / 2;
      const Pair pictures{dualPicture(scene, shooter, hair, half, how.surroundingRays, options_),
                          dualPicture(scene, shooter, hair, half, how.surroundingRays, other)};
      found.push_back(distanceTo(pictures, truth));
      plot_.samples.push_back(sampleOf(how.method, name, "rays", found.back(), watch.seconds()));
    }
    const Bar bar = options_.quick ? Bar::None : Bar::AtMost;
    // As they are meant to be used: the paper's with its 0.7, ours with the hair around measured.
    compare(name + ", as used", found[4], found[0], bar);
    // The formulas alone, both with the density that adds no fudge.
    compare(name + ", formulas alone at density 1", found[3], found[2], bar);
    compare(name + ", formulas alone at density 0.7", found[1], found[0], Bar::None);
    figures_.push_back({name + ": mean colour, corrected, worst channel off by",
                        std::abs(found[4].colorRatio - 1), "", colorBar > 0 ? bar : Bar::None, colorBar});
  }

  void finish(BenchReport& report) {
    report.plots.push_back(std::move(plot_));
    report.figures.insert(report.figures.end(), figures_.begin(), figures_.end());
  }

 private:
  void compare(const std::string& name, const Distance& corrected, const Distance& printed, Bar bar) {
    const double ratio = corrected.relMse / printed.relMse,
                 interval = differenceInterval(corrected.pixels, printed.pixels) / printed.relMse;
    figures_.push_back({name + ": relative MSE, corrected / printed", ratio, ""});
    figures_.push_back({"the same, half of its 95 % interval", interval, ""});
    figures_.push_back({"the same, low end of its 95 % interval", ratio - interval, "", bar, 1});
    figures_.push_back({name + ": FLIP, corrected / printed", corrected.flip / printed.flip, "", bar, 1});
  }

  /// The truth's own noise, as a relative MSE of one of its two pictures.
  void noise(const std::string& name, const PathTracePicture& truth) {
    FloatImage off = truth.image;
    for (std::size_t i = 0; i < off.rgba.size(); ++i) off.rgba[i] += truth.standardError.rgba[i];
    plot_.samples.push_back(sampleOf("path traced", name, std::to_string(truth.samplesPerPixel) + " samples",
                                     distanceTo(off, truth.image), truth.seconds));
  }

  const BenchOptions& options_;
  int dualSamples_;
  BenchPlot plot_;
  std::vector<BenchFigure> figures_;
};

double colorBarOf(HairColor color) {
  if (color == HairColor::Black || color == HairColor::Brown) return 0.10;
  return color == HairColor::Blond ? 0.15 : 0;
}

void compareClusters(Comparison& comparison, const Settings& settings, const BenchOptions& options) {
  const auto cluster = [&](double around, double along) {
    ScatteringScene scene = clusterScene(settings.clusterSide, around, along, options.seed);
    scene.size = settings.clusterSize;
    return scene;
  };
  const ScatteringScene front = cluster(20, 15);
  const StrandShooter shooter = shooterOf(front);  // the light alone differs between the clusters
  for (const HairColor color : settings.colors) {
    comparison.run(front, shooter, std::string("cluster, ") + nameOf(color), fibreOf(color),
                   settings.clusterSamples, colorBarOf(color));
  }
  if (options.quick) return;
  for (const auto& [around, along] :
       {std::pair(-30., 0.), std::pair(20., 45.), std::pair(60., 0.), std::pair(20., -45.)}) {
    comparison.run(
        cluster(around, along), shooter,
        "cluster, blond, light at " + shortNumber(around) + " around and " + shortNumber(along) + " along",
        fibreOf(HairColor::Blond), settings.clusterSamples, 0);
  }
  for (const double roughness : {0.15, 0.5}) {
    comparison.run(front, shooter, "cluster, blond, longitudinal roughness " + shortNumber(roughness),
                   fibreOf(HairColor::Blond, roughness), settings.clusterSamples, 0);
  }
}

struct MapChoice {
  std::string method, choice;
  VisibilityOptions options;
};

/// Voxels along the light (opacity maps of many slices), layers and bits: what the sums are kept in.
std::vector<MapChoice> mapChoices(bool quick) {
  std::vector<MapChoice> out;
  VisibilityOptions how;
  how.filter = true;
  how.method = VisibilityMethod::Opacity;
  for (const int slices : quick ? std::vector{32} : std::vector{8, 32, 128}) {
    how.slices = slices;
    out.push_back({"voxels", std::to_string(slices) + " slices", how});
  }
  how.method = VisibilityMethod::DeepOpacity;
  for (const int layers : quick ? std::vector{7} : std::vector{3, 4, 7, 15}) {
    how.layers = layers;
    out.push_back({"deep opacity", std::to_string(layers) + " layers", how});
  }
  how.method = VisibilityMethod::Occupancy;
  out.push_back({"occupancy", "128/4", how});
  how.method = VisibilityMethod::Exact;
  out.push_back({"sorted lists", "all", how});
  return out;
}

/// Forward scattering maps of a scene's lights, and the head's shadow beside them.
class SceneMaps {
 public:
  SceneMaps(const ScatteringScene& scene, const DualScattering& hair, VisibilityOptions how,
            double shiftTexels, const BenchOptions& options) {
    std::vector<Vec3> points;
    for (const Vec3f& p : scene.strands.points) points.push_back(p.cast<double>());
    const Box box = bounds(points);
    for (const ShiningLight& light : shiningLights(scene.lights, require(frameOf(scene.camera)))) {
      LightView view = distantLightView(light.toLight, box, options.quick ? 64 : 512);
      view.eye += shiftTexels * view.texel * (view.right + 0.57 * view.up);
      heads_.push_back(
          std::make_unique<OpaqueMap>(require(OpaqueMap::make(scene.head, view, options.context))));
      how.opaque = heads_.back().get();
      maps_.push_back(std::make_unique<ForwardScatteringMap>(
          require(ForwardScatteringMap::build(scene.strands, hair, view, how, options.context))));
      pointers_.push_back(maps_.back().get());
    }
  }
  std::span<const ForwardScatteringMap* const> all() const { return pointers_; }
  double bytesPerTexel() const { return pointers_[0]->map().bytesPerTexel(); }

 private:
  std::vector<std::unique_ptr<OpaqueMap>> heads_;
  std::vector<std::unique_ptr<ForwardScatteringMap>> maps_;
  std::vector<const ForwardScatteringMap*> pointers_;
};

/// Mean |Δ| of the colours over the mean colour.
double meanChange(const FloatImage& a, const FloatImage& b) {
  double change = 0, mean = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i) {
    if (i % 4 == 3) continue;
    change += std::abs(double(a.rgba[i]) - double(b.rgba[i]));
    mean += double(a.rgba[i]);
  }
  return mean > 0 ? change / mean : 0;
}

/// The channel's ratio of means that is farthest from 1.
double colorRatio(const FloatImage& picture, const FloatImage& truth) {
  return distanceTo(picture, truth).colorRatio;
}

/// Error against time and memory on blond hair: samples a pixel of the truth, rays and maps.
void addMethods(const ScatteringScene& scene, const StrandShooter& shooter, int truthSamples,
                const BenchOptions& options, BenchReport& report) {
  BenchPlot plot;
  plot.name = "scattering-methods-" + scene.name;
  plot.title = "Global scattering, blond " + scene.name + ": path traced, rays, maps";
  plot.errorUnit = "relative MSE to the path tracer";
  plot.truth = std::to_string(truthSamples) + " samples a pixel, another seed";
  const FibreParameters fibre = fibreOf(HairColor::Blond);
  const FloatImage truth = traced(scene, fibre, truthSamples, options).image;
  BenchOptions other = options;
  other.seed += 77;
  for (const int samples : {2, 8, 32}) {
    const PathTracePicture picture = traced(scene, fibre, samples, other);
    plot.samples.push_back(sampleOf("path traced", scene.name, std::to_string(samples) + " samples",
                                    distanceTo(picture.image, truth), picture.seconds));
  }
  const DualScattering hair(FibreScattering(fibre), {DualFormulas::Corrected, 1, 1});
  for (const int rays : {0, measured().surroundingRays}) {
    for (const int samples : {2, 8}) {
      const Stopwatch watch;
      const FloatImage picture = dualPicture(scene, shooter, hair, samples, rays, options);
      plot.samples.push_back(sampleOf(rays == 0 ? "rays, straight path" : "rays, hair around measured",
                                      scene.name, std::to_string(samples) + " samples",
                                      distanceTo(picture, truth), watch.seconds()));
    }
  }
  constexpr int kSamples = 8;
  const FloatImage straight = dualPicture(scene, shooter, hair, kSamples, 0, options);
  BenchPlot bytes;
  for (const MapChoice& choice : mapChoices(options.quick)) {
    const Stopwatch watch;
    const SceneMaps maps(scene, hair, choice.options, 0, options);
    const FloatImage picture = dualPicture(scene, shooter, hair, kSamples, 0, options, maps.all());
    BenchSample sample =
        sampleOf(choice.method, scene.name, choice.choice, distanceTo(picture, truth), watch.seconds());
    const SceneMaps moved(scene, hair, choice.options, 0.37, options);
    const double ratio = colorRatio(picture, straight);
    sample.measures = {{"bytes a texel", maps.bytesPerTexel()},
                       {"mean colour over the rays'", ratio},
                       {"flicker", meanChange(picture, dualPicture(scene, shooter, hair, kSamples, 0, options,
                                                                   moved.all()))}};
    report.figures.push_back({scene.name + ", " + choice.method + ", " + choice.choice +
                                  ": mean colour over that of rays, worst channel",
                              ratio, ""});
    bytes.samples.push_back(sample);
    plot.samples.push_back(std::move(sample));
  }
  std::vector<BenchSample> maps = std::move(bytes.samples);
  bytes = plot;
  bytes.samples = std::move(maps);
  bytes.name += "-bytes";
  bytes.against = "bytes a texel";
  report.plots.push_back(std::move(plot));
  report.plots.push_back(std::move(bytes));
}

/// How the picture depends on the density factors.
BenchPlot densityPlot(const ScatteringScene& scene, const StrandShooter& shooter, int truthSamples,
                      const BenchOptions& options) {
  BenchPlot plot;
  plot.name = "scattering-density";
  plot.title = "Density factors on the blond bob";
  plot.errorUnit = "mean FLIP to the path tracer";
  plot.against = "density factors d_f, d_b";
  plot.curves = true;
  plot.truth = std::to_string(truthSamples) + " samples a pixel";
  const FibreParameters fibre = fibreOf(HairColor::Blond);
  const FloatImage truth = traced(scene, fibre, truthSamples, options).image;
  for (const DualFormulas formulas : {DualFormulas::Printed, DualFormulas::Corrected}) {
    for (const double density : {0.0, 0.4, 0.6, 0.7, 0.8, 1.0}) {
      const Choice how = choice(formulas, density);
      const DualScattering hair(FibreScattering(fibre), how.dual);
      const Stopwatch watch;
      const FloatImage picture = dualPicture(scene, shooter, hair, 8, 0, options);
      const Distance distance = distanceTo(picture, truth);
      BenchSample sample = sampleOf(formulas == DualFormulas::Printed ? "printed" : "corrected", scene.name,
                                    shortNumber(density), distance, watch.seconds());
      sample.error = distance.flip;
      sample.measures = {{plot.against, density}};
      plot.samples.push_back(std::move(sample));
    }
  }
  return plot;
}

}  // namespace

BenchReport benchScattering(const BenchOptions& options) {
  BenchReport report;
  report.title = "Multiple scattering";
  report.about =
      "Chiang's fibre, the same in the path tracer and in dual scattering; distant lights. A cube of nearly "
      "parallel "
      "fibres and a bob. The error is the relative mean squared error of pictures exposed to a mean of 0.3 "
      "where "
      "there is hair; FLIP and the ratio of mean colours, worst channel, are in the data. 'Printed' is the "
      "paper's "
      "formulas, 'corrected' those of docs/light.md; both with the straight path to the light and density "
      "factors, "
      "corrected also with the hair around measured by rays, which is the default.";
  const Settings settings = settingsOf(options);
  Comparison comparison(options, settings.dualSamples);
  compareClusters(comparison, settings, options);
  ScatteringScene bob = styledScene("bob", settings.hairs, options);
  bob.size = settings.bobSize;
  const StrandShooter shooter = shooterOf(bob);
  for (const HairColor color : settings.colors) {
    comparison.run(bob, shooter, std::string("bob, ") + nameOf(color), fibreOf(color), settings.bobSamples,
                   colorBarOf(color));
  }
  comparison.finish(report);
  addMethods(bob, shooter, settings.bobSamples, options, report);
  if (options.quick) return report;
  report.plots.push_back(densityPlot(bob, shooter, settings.bobSamples, options));
  ScatteringScene cluster = clusterScene(settings.clusterSide, 20, 15, options.seed);
  cluster.size = settings.clusterSize;
  addMethods(cluster, shooterOf(cluster), settings.bobSamples, options, report);
  ScatteringScene longHair = styledScene("long", settings.hairs, options);
  longHair.size = settings.bobSize;
  addMethods(longHair, shooterOf(longHair), settings.bobSamples, options, report);
  return report;
}

}  // namespace coif
