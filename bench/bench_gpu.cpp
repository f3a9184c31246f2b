// Frames of the preview: milliseconds for what it draws, keeps and leaves out, on the device that is there.
#include <cmath>
#include <functional>
#include <optional>

#include "bench/bench.h"
#include "bench/preview_problem.h"
#include "coif/light/image_metrics.h"
#include "coif/preview/session.h"

namespace coif {
namespace {

struct Size {
  std::size_t strands;
  int width, height;
};

/// What a frame may be: each is timed with every strand and every point, but where it says otherwise.
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

/// Besides deep opacity maps of seven layers.
std::vector<Variant> shadowVariants() {
  using enum VisibilityMethod;
  std::vector<Variant> all;
  for (const int layers : {3, 15}) all.push_back(shadowsBy(DeepOpacity, layers));
  for (const VisibilityMethod method : {Occupancy, Exact, LightMap}) all.push_back(shadowsBy(method));
  for (const int slices : {32, 128}) all.push_back(shadowsBy(Opacity, 7, slices));
  all.push_back(shadowsBy(DensityClustering));
  return all;
}

std::vector<Variant> eyeVariants() {
  using enum PreviewTransparency;
  const auto by = [](PreviewTransparency method) {
    return [method](PreviewOptions& o) { o.transparency = method; };
  };
  return {{"stochastic", by(Stochastic)},
          {"depth layers (compute rasteriser)", by(DepthLayers)},
          {"level of detail", [](PreviewOptions& o) { o.lod = true; }},
          {"dual scattering", [](PreviewOptions& o) { o.shading = PreviewShading::DualScattering; }},
          {"opaque", by(Opaque)},
          {"alpha to coverage", by(AlphaToCoverage)},
          {"weighted average", by(WeightedAverage)},
          {"occupancy-ordered", by(OccupancyOrdered)},
          {"exact lists", by(ExactLists)},
          {"half-angle slices", by(HalfAngleSlices)}};
}

PreviewOptions frameOptions(const Size& size) {
  PreviewOptions options;
  options.width = size.width, options.height = size.height;
  options.subframes = 1;
  options.lod = false;
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

/// The report's figures, told of as they come, while there is time.
class Rows {
 public:
  Rows(BenchReport& report, const BenchOptions& options) : report_(report), options_(options) {}
  void add(BenchFigure figure) {
    if (options_.onFigure) options_.onFigure(figure);
    report_.figures.push_back(std::move(figure));
  }
  void addSeconds(const std::string& what, double seconds) { add({what, 1000 * seconds, "ms"}); }
  /// False past the budget; the report then says what was left out.
  bool timeFor(const std::string& what) {
    if (!(options_.budgetSeconds > 0) || watch_.seconds() < options_.budgetSeconds) return true;
    report_.about += " Left out, since the budget was spent: " + what + ".";
    return false;
  }
  void say(const std::string& sentence) { report_.about += " " + sentence; }

 private:
  BenchReport& report_;
  const BenchOptions& options_;
  Stopwatch watch_;
};

/// How often a frame is timed: the first, which compiles shaders, is not counted, and one is enough of those
/// that take long.
template <class Render>
Status timeFrames(bool quick, const Render& render) {
  constexpr double kLong = 0.5;
  const int frames = quick ? 2 : 4;
  for (int k = 0; k < frames; ++k) {
    COIF_ASSIGN(const double seconds, render(k));
    if (k > 0 && seconds > kLong) break;
  }
  return {};
}

struct Frame {
  double total = INFINITY, maps = INFINITY, strands = INFINITY, drawing = INFINITY, bytes = 0;
};

/// What a map costs by its algorithm, whatever the device: segments walked and texels touched in all passes,
/// and the bytes that these move. A segment is two points of 32 bytes, a texel a number of 4 that is read and
/// written; the map itself is filled, summed up and read once.
void addWork(const Picture& picture, double mapBytes, const std::string& what, Rows& rows) {
  const double segments = double(picture.work.mapSegments), texels = double(picture.work.mapTexels);
  rows.add({what + ": segments walked into the map", segments, ""});
  rows.add({what + ": texels touched", texels, ""});
  rows.add({what + ": bytes moved", 64 * segments + 8 * texels + 3 * mapBytes, "bytes"});
}
Result<Frame> fastestFrame(PreviewSession& session, const PreviewOptions& options, bool quick) {
  Frame best;
  COIF_TRY(timeFrames(quick, [&](int k) -> Result<double> {
    COIF_ASSIGN(const Picture picture, session.render(options));
    if (k == 0) return picture.seconds;
    best.total = std::min(best.total, picture.seconds);
    best.maps = std::min(best.maps, secondsOf(picture, "shadow maps"));
    best.strands = std::min(best.strands, secondsOf(picture, "strands for the eye"));
    best.drawing = std::min(best.drawing, secondsOf(picture, "picture"));
    return picture.seconds;
  }));
  return best;
}

/// The fastest of several frames, each with another light.
Result<Frame> fastestMovingLight(PreviewSession& session, const PreviewOptions& options, bool quick) {
  Frame best;
  const Status status = timeFrames(quick, [&](int k) -> Result<double> {
    session.setLights(fixedLights(k + 1));
    COIF_ASSIGN(const Picture picture, session.render(options));
    if (k == 0) return picture.seconds;
    best.total = std::min(best.total, picture.seconds);
    best.maps = std::min(best.maps, secondsOf(picture, "shadow maps"));
    for (const StageReport& stage : picture.stages) {
      if (stage.name == "shadow maps") best.bytes = double(stage.bytes);
    }
    return picture.seconds;
  });
  session.setLights(fixedLights());
  COIF_TRY(status);
  return best;
}

/// What is measured of one number of strands.
struct Subject {
  Size size;
  std::string prefix;
  PreviewSession session;
  double unshadowed = NAN;  ///< seconds of a frame
};

// A method whose lists the driver cannot hold is said to be left out; any other error ends the bench.
std::optional<Frame> orSay(Result<Frame> measured, const std::string& what, Rows& rows) {
  if (measured.ok()) return *measured;
  if (measured.error().code != ErrorCode::TooLarge) throw BenchFault{measured.error()};
  rows.say("Not measured: " + what + ", because " + measured.error().message + ".");
  return {};
}

/// Counted in a frame of its own: it takes one more pass over the strands.
void countWork(Subject& subject, PreviewOptions frame, double mapBytes, const std::string& what, Rows& rows) {
  frame.count = true, frame.keep = false;
  const Picture picture = require(subject.session.render(frame));
  if (picture.work.mapSegments > 0) addWork(picture, mapBytes, what, rows);
}

/// The frame whose light moved, by a shadow method.
void measureShadow(Subject& subject, const Variant& variant, const BenchOptions& options, Rows& rows) {
  const std::string what = subject.prefix + variant.name;
  if (!rows.timeFor(what)) return;
  PreviewOptions frame = frameOptions(subject.size);
  variant.set(frame);
  const auto measured = orSay(fastestMovingLight(subject.session, frame, options.quick), what, rows);
  if (!measured) return;
  rows.addSeconds(what + ": frame, the light moved", measured->total);
  if (!frame.shadows) {
    subject.unshadowed = measured->total;
    return;
  }
  rows.addSeconds(what + ": shadow maps alone", measured->maps);
  rows.add({what + ": bytes of the maps", measured->bytes, "bytes"});
  countWork(subject, frame, measured->bytes, what, rows);
}

/// The paper's claim: shadows cost no more than the picture itself.
void measureBar(Subject& subject, const BenchOptions& options, Rows& rows) {
  measureShadow(subject, {"no shadows", [](PreviewOptions& o) { o.shadows = false; }}, options, rows);
  PreviewOptions frame = frameOptions(subject.size);
  const Variant deep = shadowsBy(VisibilityMethod::DeepOpacity);
  deep.set(frame);
  const Frame moved = require(fastestMovingLight(subject.session, frame, options.quick));
  rows.addSeconds(subject.prefix + deep.name + ": frame, the light moved", moved.total);
  rows.addSeconds(subject.prefix + deep.name + ": shadow maps alone", moved.maps);
  rows.add({subject.prefix + deep.name + ": bytes of the maps", moved.bytes, "bytes"});
  countWork(subject, frame, moved.bytes, subject.prefix + deep.name, rows);
  rows.add({subject.prefix + "the light moved, deep opacity maps of 7 layers over no shadows",
            moved.total / subject.unshadowed, "", options.quick ? Bar::None : Bar::AtMost, 2});
  const Frame still = require(fastestFrame(subject.session, frame, options.quick));
  rows.addSeconds(subject.prefix + deep.name + ": frame, light and hair still", still.total);
  frame.keep = false;
  const Frame fresh = require(fastestFrame(subject.session, frame, options.quick));
  rows.addSeconds(subject.prefix + deep.name + ": frame, everything made again", fresh.total);
  rows.addSeconds(subject.prefix + "making the points (compute)", fresh.strands);
}

/// A frame with everything kept that may be.
void measureEye(Subject& subject, const Variant& variant, const BenchOptions& options, Rows& rows) {
  const std::string what = subject.prefix + variant.name;
  if (!rows.timeFor(what)) return;
  PreviewOptions frame = frameOptions(subject.size);
  variant.set(frame);
  const auto measured = orSay(fastestFrame(subject.session, frame, options.quick), what, rows);
  if (!measured) return;
  rows.addSeconds(what + ": frame, light and hair still", measured->total);
  rows.addSeconds(what + ": drawing", measured->drawing);
}

void measureCompute(Subject& subject, Rows& rows) {
  if (!rows.timeFor(subject.prefix + "compute rasteriser")) return;
  require(subject.session.render(frameOptions(subject.size)));  // the strands that are drawn again
  for (const bool nearest : {false, true}) {
    const ComputeCoverage coverage =
        require(subject.session.coverageByCompute(subject.size.width, subject.size.height, nearest));
    rows.addSeconds(subject.prefix + (nearest ? "compute rasteriser, coverage and nearest depth"
                                              : "compute rasteriser, coverage"),
                    coverage.seconds);
  }
}

/// What goes to the GPU when one thing changes.
void measureUploads(Subject& subject, const HairMesh& mesh, const BenchOptions& options, Rows& rows) {
  if (!rows.timeFor(subject.prefix + "uploads")) return;
  PreviewSession& session = subject.session;
  std::vector<Vec3> positions;
  for (const HairVertex& v : mesh.vertices()) positions.push_back(v.position + Vec3(0.001, 0, 0));
  const PreviewOptions frame = frameOptions(subject.size);
  const auto strandBytes = [&](const char* what, const Picture& picture) {
    rows.add({subject.prefix + "strand bytes uploaded when " + what, double(picture.uploaded.strands),
              "bytes", Bar::AtMost, 0});
  };
  const double aspect = double(subject.size.width) / subject.size.height;
  session.setCamera(frameBox(bounds(positions), UpAxis::Z, 75, 10, aspect));
  strandBytes("the camera moves", require(session.render(frame)));
  session.setLights(fixedLights(6));
  strandBytes("the light moves", require(session.render(frame)));
  if (const Status moved = session.moveHair(positions, options.context); !moved.ok())
    throw BenchFault{moved.error()};
  const Picture picture = require(session.render(frame));
  rows.add(
      {subject.prefix + "bytes uploaded when the mesh moves", double(picture.uploaded.hairMesh), "bytes"});
  strandBytes("the mesh moves", picture);
}

/// The picture's error and time over the fraction of the strands.
BenchPlot detailPlot(PreviewSession& session, const Size& size, Rows& rows) {
  BenchPlot plot;
  plot.name = "gpu-detail";
  plot.title = "Level of detail";
  plot.errorUnit = "mean FLIP against every strand and point";
  plot.truth = "the same sub-frames with every strand and every point";
  PreviewOptions options = frameOptions(size);
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
    if (fraction == 0) rows.add({"FLIP of the automatic level of detail", error, ""});
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
      "the device is waited for after each stage. Fastest of three frames, or one of those that take more "
      "than "
      "half a second; what matters most comes first. Without a GPU the sizes are "
      "smaller; the names of the figures say which.";
  const bool small = options.quick || preview->software();
  const std::vector<Size> sizes = options.quick ? std::vector<Size>{{2000, 160, 90}}
                                  : small       ? std::vector<Size>{{20000, 960, 540}, {100000, 960, 540}}
                                          : std::vector<Size>{{100000, 1920, 1080}, {1000000, 1920, 1080}};
  const HairMesh mesh = previewProblemMesh(options);
  Rows rows(report, options);
  std::vector<Subject> subjects;
  for (const Size& size : sizes) {
    const std::string prefix = std::to_string(size.strands) + " × 32, ";
    if (!rows.timeFor(prefix + "everything")) continue;
    subjects.push_back(
        {size, prefix,
         previewProblem(*preview, mesh, size.strands, double(size.width) / size.height, options)});
    measureBar(subjects.back(), options, rows);
    measureCompute(subjects.back(), rows);
  }
  for (const Variant& variant : eyeVariants()) {
    for (Subject& subject : subjects) measureEye(subject, variant, options, rows);
  }
  for (const Variant& variant : shadowVariants()) {
    for (Subject& subject : subjects) measureShadow(subject, variant, options, rows);
  }
  for (Subject& subject : subjects) measureUploads(subject, mesh, options, rows);
  if (rows.timeFor("the level of detail's error over its time"))
    report.plots.push_back(
        detailPlot(subjects.front().session, {0, sizes.front().width / 2, sizes.front().height / 2}, rows));
  return report;
}

}  // namespace coif
