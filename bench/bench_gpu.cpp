// Frames of the preview: milliseconds for what it draws, keeps and leaves out, on the device that is there.
#include <cmath>
#include <functional>
#include <optional>

#include "bench/bench.h"
#include "bench/place_problem.h"
#include "coif/light/image_metrics.h"
#include "coif/preview/session.h"
#include "coif/strands/grow.h"

namespace coif {
namespace {

struct Size {
  std::size_t strands;
  int width, height;
};

/// What a frame may be: each is timed with every strand and every point.
struct Variant {
  std::string name;
  std::function<void(PreviewOptions&)> set;
};

Variant shadowsBy(VisibilityMethod method, int layers = 7, int slices = 128) {
  std::string label = name(method);
  if (method == VisibilityMethod::DeepOpacity) label += ", " + std::to_string(layers) + " layers";
  if (method == VisibilityMethod::Opacity) label += ", " + std::to_string(slices) + " slices";
  return {label, [=](PreviewOptions& o) {
            o.visibility.method = method, o.visibility.layers = layers, o.visibility.slices = slices;
          }};
}

std::vector<Variant> shadowVariants() {
  using enum VisibilityMethod;
  std::vector<Variant> all = {{"no shadows", [](PreviewOptions& o) { o.shadows = false; }}};
  for (const int layers : {3, 7, 15}) all.push_back(shadowsBy(DeepOpacity, layers));
  for (const int slices : {32, 128}) all.push_back(shadowsBy(Opacity, 7, slices));
  for (const VisibilityMethod method : {DensityClustering, LightMap, Occupancy, Exact})
    all.push_back(shadowsBy(method));
  return all;
}

std::vector<Variant> eyeVariants() {
  using enum PreviewTransparency;
  const auto by = [](PreviewTransparency method) {
    return [method](PreviewOptions& o) { o.transparency = method; };
  };
  return {{"opaque", by(Opaque)},
          {"stochastic", by(Stochastic)},
          {"alpha to coverage", by(AlphaToCoverage)},
          {"weighted average", by(WeightedAverage)},
          {"occupancy-ordered", by(OccupancyOrdered)},
          {"exact lists", by(ExactLists)},
          {"depth layers (compute rasteriser)", by(DepthLayers)},
          {"half-angle slices", by(HalfAngleSlices)},
          {"dual scattering", [](PreviewOptions& o) { o.shading = PreviewShading::DualScattering; }}};
}

PreviewOptions frameOptions(const Size& size, bool lod) {
  PreviewOptions options;
  options.width = size.width, options.height = size.height;
  options.subframes = 1;
  options.lod = lod;
  options.measure = true;
  return options;
}

double secondsOf(const Picture& picture, const std::string& stage) {
  double sum = 0;
  for (const StageReport& report : picture.stages) {
    if (report.name == stage) sum += report.seconds;
  }
  return sum;
}

/// Fastest of a few frames; the first, which compiles shaders, is not counted.
struct Frame {
  double total = INFINITY, maps = INFINITY, strands = INFINITY, drawing = INFINITY, bytes = 0;
};
Result<Frame> fastestFrame(PreviewSession& session, const PreviewOptions& options, bool quick) {
  Frame best;
  for (int k = 0; k < (quick ? 2 : 4); ++k) {
    COIF_ASSIGN(const Picture picture, session.render(options));
    if (k == 0) continue;
    best.total = std::min(best.total, picture.seconds);
    best.maps = std::min(best.maps, secondsOf(picture, "shadow maps"));
    best.strands = std::min(best.strands, secondsOf(picture, "strands for the eye"));
    best.drawing = std::min(best.drawing, secondsOf(picture, "picture"));
    for (const StageReport& stage : picture.stages) {
      if (stage.name == "shadow maps") best.bytes = double(stage.bytes);
    }
  }
  return best;
}

/// Lights that stay in the scene while the camera moves, the key turned a little.
Lights fixedLights(int turn = 0) {
  Lights lights;
  lights.followCamera = false;
  lights.key.direction += Vec3(0.05 * turn, 0, 0);
  return lights;
}

PreviewSession sessionOf(Preview& preview, const HairMesh& mesh, std::size_t strands,
                         const BenchOptions& options) {
  GrowOptions grow;
  grow.count = strands;
  grow.points = 2;  // the GPU makes the 32
  grow.seed = options.seed;
  grow.width = 4e-4;
  const StrandSet roots = require(coif::grow(mesh, grow, options.context)).strands;
  PreviewSession session(preview);
  if (const Status set = session.setHair(mesh, roots, Knots::Uniform, 32, options.context); !set.ok())
    throw BenchFault{set.error()};
  std::vector<Vec3> positions;
  for (const HairVertex& v : mesh.vertices()) positions.push_back(v.position);
  session.setCamera(frameBox(bounds(positions), UpAxis::Z, 30, 20, 16.0 / 9));
  session.setLights(fixedLights());
  return session;
}

void addFigure(BenchReport& report, const std::string& what, double seconds) {
  report.figures.push_back({what, 1000 * seconds, "ms"});
}

/// The fastest frame of several, each with another light.
double fastestMovingLight(PreviewSession& session, const PreviewOptions& options, bool quick) {
  double best = INFINITY;
  for (int k = 0; k < (quick ? 2 : 4); ++k) {
    session.setLights(fixedLights(k + 1));
    const double seconds = require(session.render(options)).seconds;
    if (k > 0) best = std::min(best, seconds);
  }
  session.setLights(fixedLights());
  return best;
}

/// A frame's milliseconds with everything kept that may be and, on request, with all made again. None where
/// the driver cannot hold the method's lists, which the report then says.
std::optional<Frame> measureVariant(PreviewSession& session, const std::string& name, const Variant& variant,
                                    const Size& size, bool fresh, const BenchOptions& options,
                                    BenchReport& report) {
  PreviewOptions frame = frameOptions(size, false);
  variant.set(frame);
  Result<Frame> measured = fastestFrame(session, frame, options.quick);
  if (measured.ok()) {
    addFigure(report, name + ": frame, light and hair still", measured->total);
    addFigure(report, name + ": drawing (graphics pipeline)", measured->drawing);
    frame.keep = false;
    if (fresh) measured = fastestFrame(session, frame, options.quick);
  }
  if (!measured.ok()) {
    if (measured.error().code != ErrorCode::TooLarge) throw BenchFault{measured.error()};
    report.about += " Not measured: " + name + ", because " + measured.error().message + ".";
    return {};
  }
  if (!fresh) return *measured;
  addFigure(report, name + ": frame, everything made again", measured->total);
  if (frame.shadows) {
    addFigure(report, name + ": shadow maps alone", measured->maps);
    report.figures.push_back({name + ": bytes of the maps", measured->bytes, "bytes"});
  }
  return *measured;
}

void measureShadows(PreviewSession& session, const std::string& prefix, const Size& size,
                    const BenchOptions& options, BenchReport& report) {
  double unshadowed = 0;
  for (const Variant& variant : shadowVariants()) {
    const auto frame = measureVariant(session, prefix + variant.name, variant, size, true, options, report);
    if (!frame) continue;
    PreviewOptions moving = frameOptions(size, false);
    variant.set(moving);
    const double seconds = fastestMovingLight(session, moving, options.quick);
    addFigure(report, prefix + variant.name + ": frame, the light moved", seconds);
    if (!moving.shadows) {
      unshadowed = seconds;
      addFigure(report, prefix + "making the points (compute)", frame->strands);
    } else if (variant.name.starts_with("deep-opacity, 7")) {
      // The paper's claim: shadows cost no more than the picture itself.
      report.figures.push_back({prefix + "the light moved, deep opacity maps of 7 layers over no shadows",
                                seconds / unshadowed, "", options.quick ? Bar::None : Bar::AtMost, 2});
    }
  }
}

void measureCompute(PreviewSession& session, const std::string& prefix, const Size& size,
                    BenchReport& report) {
  require(session.render(frameOptions(size, false)));  // the strands that are drawn again
  for (const bool nearest : {false, true}) {
    const ComputeCoverage coverage = require(session.coverageByCompute(size.width, size.height, nearest));
    addFigure(report,
              prefix + (nearest ? "compute rasteriser, coverage and nearest depth"
                                : "compute rasteriser, coverage"),
              coverage.seconds);
  }
}

/// What goes to the GPU when one thing changes.
void measureUploads(PreviewSession& session, const HairMesh& mesh, const std::string& prefix,
                    const Size& size, const BenchOptions& options, BenchReport& report) {
  std::vector<Vec3> positions;
  for (const HairVertex& v : mesh.vertices()) positions.push_back(v.position + Vec3(0.001, 0, 0));
  const PreviewOptions frame = frameOptions(size, false);
  const auto strandBytes = [&](const char* what, const Picture& picture) {
    report.figures.push_back({prefix + "strand bytes uploaded when " + what, double(picture.uploaded.strands),
                              "bytes", Bar::AtMost, 0});
  };
  session.setCamera(frameBox(bounds(positions), UpAxis::Z, 75, 10, double(size.width) / size.height));
  strandBytes("the camera moves", require(session.render(frame)));
  session.setLights(fixedLights(6));
  strandBytes("the light moves", require(session.render(frame)));
  if (const Status moved = session.moveHair(positions, options.context); !moved.ok())
    throw BenchFault{moved.error()};
  const Picture picture = require(session.render(frame));
  report.figures.push_back(
      {prefix + "bytes uploaded when the mesh moves", double(picture.uploaded.hairMesh), "bytes"});
  strandBytes("the mesh moves", picture);
}

void measureSize(PreviewSession& session, const HairMesh& mesh, const Size& size, const BenchOptions& options,
                 BenchReport& report) {
  const std::string prefix = std::to_string(size.strands) + " × 32, ";
  measureShadows(session, prefix, size, options, report);
  for (const Variant& variant : eyeVariants())
    measureVariant(session, prefix + variant.name, variant, size, false, options, report);
  addFigure(report, prefix + "level of detail: frame, light and hair still",
            require(fastestFrame(session, frameOptions(size, true), options.quick)).total);
  measureCompute(session, prefix, size, report);
  measureUploads(session, mesh, prefix, size, options, report);
}

/// The picture's error and time over the fraction of the strands.
BenchPlot detailPlot(PreviewSession& session, const Size& size, BenchReport& report) {
  BenchPlot plot;
  plot.name = "gpu-detail";
  plot.title = "Level of detail";
  plot.errorUnit = "mean FLIP against every strand and point";
  plot.truth = "the same sub-frames with every strand and every point";
  PreviewOptions options = frameOptions(size, false);
  options.subframes = 4;
  const FloatImage truth = toLinear(require(session.render(options)).image);
  options.lod = true;
  for (const double fraction : {0.02, 0.05, 0.1, 0.2, 0.5, 0.0}) {
    options.strandFraction = fraction;
    options.subframes = 4;
    const Picture picture = require(session.render(options));
    const double error = require(flip(toLinear(picture.image), truth)).mean;
    const Picture timed = require(session.render(options));
    plot.samples.push_back({fraction > 0 ? "part of the strands" : "auto",
                            {{"strands", std::to_string(picture.strandsDrawn)},
                             {"segments", std::to_string(picture.segmentsDrawn)}},
                            error,
                            timed.seconds,
                            0});
    if (fraction == 0) report.figures.push_back({"FLIP of the automatic level of detail", error, ""});
  }
  return plot;
}

}  // namespace

BenchReport benchGpu(const BenchOptions& options) {
  BenchReport report;
  report.title = "Frames of the preview";
  Result<Preview> preview = Preview::create();
  if (!preview.ok()) {
    report.about = "Nothing was measured: " + preview.error().text();
    return report;
  }
  report.title += " on " + preview->renderer();
  report.about =
      "Device: " + preview->renderer() + (preview->software() ? " (no GPU)" : "") +
      ". Hair of 20 by 20 bundles and 10 layers, points made on the device, one sub-frame of four samples; "
      "the device is waited for after each stage. Fastest of three frames. Without a GPU the sizes are "
      "smaller; the names of the figures say which.";
  const bool small = options.quick || preview->software();
  const std::vector<Size> sizes = options.quick ? std::vector<Size>{{2000, 160, 90}}
                                  : small       ? std::vector<Size>{{20000, 960, 540}, {100000, 960, 540}}
                                          : std::vector<Size>{{100000, 1920, 1080}, {1000000, 1920, 1080}};
  const HairMesh mesh = placeProblemMesh({20, 10, PlaceKind::Uniform}, options.seed);
  for (const Size& size : sizes) {
    PreviewSession session = sessionOf(*preview, mesh, size.strands, options);
    if (&size == &sizes.front())
      report.plots.push_back(detailPlot(session, {0, size.width / 2, size.height / 2}, report));
    measureSize(session, mesh, size, options, report);
  }
  return report;
}

}  // namespace coif
