// A picture of a bob, from strands in memory to bytes: seconds, and FLIP to the path tracer, over sub-frames, the level of
// detail and ways of drawing; four hair colours.
#include "bench/bench.h"
#include "bench/bench_text.h"
#include "bench/scattering_scene.h"
#include "coif/io/safe_file.h"
#include "coif/light/hair_color.h"
#include "coif/light/image_metrics.h"
#include "coif/light/path_tracer.h"
#include "coif/preview/preview.h"

namespace coif {
namespace {

struct Settings {
  std::size_t hairs;
  int size, samples, smallSize, smallSamples;  ///< of the truth, twice each
};

Settings settingsOf(const BenchOptions& options) {
  Settings settings = options.quick ? Settings{4000, 64, 16, 48, 8} : Settings{100000, 512, 12, 256, 40};
  if (options.truthSamples > 0) settings.samples = settings.smallSamples = options.truthSamples;
  return settings;
}

ScatteringScene pictureScene(std::size_t hairs, const BenchOptions& options) {
  ScatteringScene scene = styledScene("bob", hairs, options, 32);
  scene.lights = Lights{};  // three lights, sky and ground
  return scene;
}

FibreParameters fibreOf(HairColor color) {
  FibreParameters fibre;
  fibre.absorption = absorptionOf(color);
  return fibre;
}

PreviewOptions pictureOptions(int size, const FibreParameters& fibre) {
  PreviewOptions options;
  options.width = options.height = size;
  options.shading = PreviewShading::DualScattering;
  options.fibre = fibre;
  options.useAbsorption = true;
  return options;
}

/// As the eye sees it: over the preview's backdrop, clipped.
FloatImage seen(const FloatImage& traced) {
  const PreviewOptions look;
  return toLinear(toSrgb(overBackdrop(traced, look.backgroundTop, look.backgroundBottom)));
}

PathTracePicture traced(const ScatteringScene& scene, const FibreParameters& fibre, int size, int samples,
                        std::uint64_t seed, const BenchOptions& options) {
  PathTraceScene world;
  world.strands = &scene.strands;
  world.head = &scene.head;
  world.camera = scene.camera;
  world.lights = scene.lights;
  world.fibre = fibre;
  PathTraceOptions how;
  how.width = how.height = size;
  how.samplesPerPixel = samples;
  how.seed = seed;
  return require(pathTrace(world, how, options.context));
}

/// The traced picture, from the folder of truths if it is there, kept there if there is a folder.
FloatImage tracedOnce(const ScatteringScene& scene, HairColor color, int size, int samples, std::uint64_t seed,
                      const BenchOptions& options) {
  const auto trace = [&] { return traced(scene, fibreOf(color), size, samples, seed, options).image; };
  if (options.truthFolder.empty()) return trace();
  const std::string name = std::string("bob-") + nameOf(color) + "-" +
                           std::to_string(scene.strands.strandCount()) + "-hairs-" + std::to_string(size) +
                           "-pixels-" + std::to_string(samples) + "-samples-seed-" + std::to_string(seed) + ".exr";
  const std::filesystem::path path = options.truthFolder / name;
  std::error_code failed;
  if (std::filesystem::exists(path, failed)) {
    FloatImage kept = require(decodeExr(require(readFile(path))));
    if (kept.width == size && kept.height == size) return kept;
    throw BenchFault{makeError(ErrorCode::Malformed, path.string() + " is no truth of this bench: it is " +
                                                         std::to_string(kept.width) + " pixels wide")};
  }
  FloatImage image = trace();
  std::filesystem::create_directories(options.truthFolder, failed);  // said when the file is made
  SafeFile file = require(SafeFile::create(path));
  file.write(require(encodeExr(image, ExrPrecision::Float)));
  if (const Status status = file.commit(); !status.ok()) throw BenchFault{status.error()};
  return image;
}

/// The mean of two runs, and how far they are from each other: twice what the mean is from the truth, or less.
struct Truth {
  FloatImage picture;
  double noise = 0;
};
Truth truthOf(const ScatteringScene& scene, HairColor color, int size, int samples,
              const BenchOptions& options) {
  FloatImage a = tracedOnce(scene, color, size, samples, options.seed, options);
  const FloatImage b = tracedOnce(scene, color, size, samples, options.seed + 1, options);
  Truth truth;
  truth.noise = require(flip(seen(a), seen(b), 67, options.context)).mean;
  for (std::size_t i = 0; i < a.rgba.size(); ++i) a.rgba[i] = 0.5f * (a.rgba[i] + b.rgba[i]);
  truth.picture = seen(a);
  return truth;
}

class Bob {
 public:
  Bob(Preview& preview, const ScatteringScene& scene, const BenchOptions& options)
      : preview_(preview), options_(options) {
    drawn_.strands = &scene.strands;
    drawn_.head = &scene.head;
    drawn_.camera = scene.camera;
    drawn_.lights = scene.lights;
  }
  struct Measured {
    double error, seconds;
    std::size_t strands;
  };
  Measured measure(const PreviewOptions& how, const FloatImage& truth) {
    const Picture first = require(preview_.render(drawn_, how, options_.context));  // compiles shaders
    double seconds = first.seconds;
    for (int k = 0; k < (options_.quick ? 1 : 3); ++k)
      seconds = std::min(seconds, require(preview_.render(drawn_, how, options_.context)).seconds);
    const double error = require(flip(toLinear(first.image), truth, 67, options_.context)).mean;
    return {error, seconds, first.strandsDrawn};
  }

 private:
  Preview& preview_;
  const BenchOptions& options_;
  PreviewScene drawn_;
};

BenchSample sampleOf(const std::string& method, const std::string& choice, const Bob::Measured& measured) {
  return {method,
          {{"choice", choice}, {"strands", std::to_string(measured.strands)}},
          measured.error,
          measured.seconds,
          0};
}

/// Error against run time of the brown bob.
void picturePlot(Bob& bob, const ScatteringScene& scene, const Settings& settings, const BenchOptions& options,
                 BenchReport& report) {
  const FibreParameters fibre = fibreOf(HairColor::Brown);
  const Truth truth = truthOf(scene, HairColor::Brown, settings.size, settings.samples, options);
  BenchPlot plot;
  plot.name = "picture";
  plot.title = "A bob, from strands in memory to the picture's bytes";
  plot.errorUnit = "mean FLIP to the path tracer";
  plot.truth = "path traced twice at " + std::to_string(settings.samples) +
               " samples a pixel; the two are " + shortNumber(truth.noise) + " from each other";
  const PathTracePicture few = traced(scene, fibre, settings.size, 16, options.seed + 2, options);
  const double error = require(flip(seen(few.image), truth.picture, 67, options.context)).mean;
  plot.samples.push_back({"path traced",
                          {{"choice", "16 samples"}, {"strands", std::to_string(settings.hairs)}},
                          error,
                          few.seconds,
                          0});
  BenchSample asked;
  for (const auto& [name, method] : {std::pair("automatic", PreviewTransparency::Auto),
                                     std::pair("depth layers", PreviewTransparency::DepthLayers),
                                     std::pair("pipeline, stochastic", PreviewTransparency::Stochastic)}) {
    for (const int subframes : {1, 2, 4}) {
      if (options.quick && subframes == 2) continue;
      PreviewOptions how = pictureOptions(settings.size, fibre);
      how.transparency = method;
      how.subframes = subframes;
      plot.samples.push_back(
          sampleOf(name, std::to_string(subframes) + " sub-frames", bob.measure(how, truth.picture)));
      if (method == PreviewTransparency::Auto) asked = plot.samples.back();  // at last four: the defaults
    }
  }
  for (const double fraction : {0.03, 0.06, 0.25, 0.5}) {
    if (options.quick && fraction != 0.25) continue;
    PreviewOptions how = pictureOptions(settings.size, fibre);
    how.subframes = 1;
    how.strandFraction = fraction;
    plot.samples.push_back(
        sampleOf("part of the strands", shortNumber(fraction), bob.measure(how, truth.picture)));
  }
  plot.rateAgainst("path traced", plot.samples.front().parameters);
  const Bar least = options.quick ? Bar::None : Bar::AtLeast, most = options.quick ? Bar::None : Bar::AtMost;
  report.figures.push_back({"brown: FLIP of the default picture", asked.error, "", most, 0.1});
  report.figures.push_back({"brown: FLIP between the truth's halves", truth.noise, ""});
  report.figures.push_back({"seconds of the default picture", asked.seconds, "s"});
  report.figures.push_back(
      {"path traced at 16 samples / default picture, seconds", few.seconds / asked.seconds, "", least, 10});
  report.plots.push_back(std::move(plot));
}

}  // namespace

BenchReport benchPicture(const BenchOptions& options) {
  BenchReport report;
  report.title = "One picture";
  Result<Preview> preview = Preview::create();
  if (!preview.ok()) {
    report.about = "Nothing was measured: " + preview.error().text();
    return report;
  }
  const Settings settings = settingsOf(options);
  const std::string side = std::to_string(settings.size);
  report.about = "Device: " + preview->renderer() + ". A bob of " + std::to_string(settings.hairs) +
                 " strands of 32 points on the example head, " + side + " × " + side +
                 ", three lights, sky and ground, deep opacity maps of 7 layers, dual scattering. Fastest of four "
                 "pictures, nothing kept between them. The path tracer has the same fibres, lights and head.";
  const ScatteringScene scene = pictureScene(settings.hairs, options);
  Bob bob(*preview, scene, options);
  picturePlot(bob, scene, settings, options, report);
  for (const HairColor color : {HairColor::Black, HairColor::Red, HairColor::Blond}) {
    if (options.quick && color != HairColor::Blond) continue;
    const FibreParameters fibre = fibreOf(color);
    const Truth truth = truthOf(scene, color, settings.smallSize, settings.smallSamples, options);
    const Bob::Measured measured = bob.measure(pictureOptions(settings.smallSize, fibre), truth.picture);
    report.figures.push_back({std::string(nameOf(color)) + ": FLIP of the default picture", measured.error, "",
                              options.quick ? Bar::None : Bar::AtMost, 0.1});
    report.figures.push_back(
        {std::string(nameOf(color)) + ": FLIP between the truth's halves", truth.noise, ""});
  }
  return report;
}

}  // namespace coif
