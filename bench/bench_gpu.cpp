// Frames of the preview: milliseconds for what it draws, keeps and leaves out, on the device that is there.
#include <cmath>

#include "bench/bench.h"
#include "bench/bench_text.h"
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
  const char* name;
  void (*set)(PreviewOptions&);
};
constexpr Variant kVariants[] = {
    {"no shadows", [](PreviewOptions& o) { o.shadows = false; }},
    {"deep opacity maps and light volume", [](PreviewOptions&) {}},
};

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
  double total = INFINITY, maps = INFINITY, strands = INFINITY, drawing = INFINITY;
};
Frame fastestFrame(PreviewSession& session, const PreviewOptions& options, bool quick) {
  Frame best;
  for (int k = 0; k < (quick ? 2 : 5); ++k) {
    const Picture picture = require(session.render(options));
    if (k == 0) continue;
    best.total = std::min(best.total, picture.seconds);
    best.maps = std::min(best.maps, secondsOf(picture, "shadow maps"));
    best.strands = std::min(best.strands, secondsOf(picture, "strands for the eye"));
    best.drawing = std::min(best.drawing, secondsOf(picture, "picture"));
  }
  return best;
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
  Lights lights;
  lights.followCamera = false;
  session.setLights(lights);
  return session;
}

void addFigure(BenchReport& report, const std::string& prefix, const std::string& what, double seconds) {
  report.figures.push_back({prefix + what, 1000 * seconds, "ms"});
}

void measureSize(PreviewSession& session, const HairMesh& mesh, const Size& size, const BenchOptions& options,
                 BenchReport& report) {
  const std::string prefix = std::to_string(size.strands) + " × 32: ";
  for (const Variant& variant : kVariants) {
    PreviewOptions full = frameOptions(size, false), lod = frameOptions(size, true);
    variant.set(full), variant.set(lod);
    addFigure(report, prefix, std::string("frame, ") + variant.name + ", light and hair still",
              fastestFrame(session, full, options.quick).total);
    addFigure(report, prefix, std::string("frame, ") + variant.name + ", level of detail",
              fastestFrame(session, lod, options.quick).total);
    full.keep = false;
    const Frame fresh = fastestFrame(session, full, options.quick);
    addFigure(report, prefix, std::string("frame, ") + variant.name + ", everything made again", fresh.total);
    if (full.shadows) addFigure(report, prefix, "shadow maps alone", fresh.maps);
    addFigure(report, prefix, std::string("making the points (compute), ") + variant.name, fresh.strands);
    addFigure(report, prefix, std::string("drawing (graphics pipeline), ") + variant.name, fresh.drawing);
  }
  for (const bool nearest : {false, true}) {
    const ComputeCoverage coverage = require(session.coverageByCompute(size.width, size.height, nearest));
    addFigure(report, prefix,
              nearest ? "compute rasteriser, coverage and nearest depth" : "compute rasteriser, coverage",
              coverage.seconds);
  }
  std::vector<Vec3> positions;
  for (const HairVertex& v : mesh.vertices()) positions.push_back(v.position + Vec3(0.001, 0, 0));
  if (const Status moved = session.moveHair(positions, options.context); !moved.ok())
    throw BenchFault{moved.error()};
  const Picture picture = require(session.render(frameOptions(size, false)));
  report.figures.push_back(
      {prefix + "bytes uploaded when the mesh moves", double(picture.uploaded.hairMesh), "bytes"});
  report.figures.push_back(
      {prefix + "strand bytes uploaded then", double(picture.uploaded.strands), "bytes", Bar::AtMost, 0});
}

/// The picture's error and time over the fraction of the strands.
BenchPlot detailPlot(PreviewSession& session, const Size& size, BenchReport& report) {
  BenchPlot plot;
  plot.name = "gpu-detail";
  plot.title = "Level of detail";
  plot.errorUnit = "mean FLIP against every strand and point";
  plot.truth = "the same sub-frames with every strand and every point";
  PreviewOptions options = frameOptions(size, false);
  options.subframes = 8;
  const FloatImage truth = toLinear(require(session.render(options)).image);
  options.lod = true;
  for (const double fraction : {0.02, 0.05, 0.1, 0.2, 0.5, 0.0}) {
    options.strandFraction = fraction;
    options.subframes = 8;
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
      "the device is waited for after each stage. Fastest of four frames. Without a GPU the sizes are "
      "smaller; the names of the figures say which.";
  const bool small = options.quick || preview->software();
  const std::vector<Size> sizes = options.quick ? std::vector<Size>{{2000, 160, 90}}
                                  : small       ? std::vector<Size>{{20000, 960, 540}, {100000, 960, 540}}
                                          : std::vector<Size>{{100000, 1920, 1080}, {1000000, 1920, 1080}};
  const HairMesh mesh = placeProblemMesh({20, 10, PlaceKind::Uniform}, options.seed);
  for (const Size& size : sizes) {
    PreviewSession session = sessionOf(*preview, mesh, size.strands, options);
    if (&size == &sizes.front())
      report.plots.push_back(detailPlot(session, {0, size.width, size.height}, report));
    measureSize(session, mesh, size, options, report);
  }
  return report;
}

}  // namespace coif
