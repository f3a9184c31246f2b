// What the preview leaves out where a scene does not need it: what each saves, by its own switch, in one run.
#include <ctime>
#include <functional>

#include "bench/preview_problem.h"
#include "coif/light/hair_color.h"

namespace coif {
namespace {

constexpr double kLessWork = 0.9;  // a skip that leaves more than this to do is none

/// A scene that does not need something, and the switch that makes it all the same.
struct Skip {
  std::string name, stage;  ///< the stage of the picture that it shortens
  std::function<void(PreviewOptions&)> scene, off;
  std::uint64_t PreviewWork::*work;  ///< what there is less of to do
  double width = 4e-4;               ///< of a hair
  bool keyLight = true;
  std::size_t strands = 100000;
};

struct Spent {
  double picture = INFINITY, stage = INFINITY;  ///< seconds of processor; of the clock
  double work = 0;                              ///< counted, of the stage
};

void fibreOf(PreviewOptions& options, HairColor color) {
  options.shading = PreviewShading::DualScattering;
  options.fibre.absorption = absorptionOf(color);
  options.useAbsorption = true;
}

std::vector<Skip> skips() {
  const auto all = [](PreviewOptions& o) { o.leaveOut = false; };
  const auto nothing = [](PreviewOptions&) {};
  const auto fresh = [](PreviewOptions& o) { o.keep = false; };
  std::vector<Skip> list = {
      {"key light's map where that light is black", "shadow maps", fresh, all, &PreviewWork::mapSegments},
      {"transparency where every hair covers a pixel", "picture",
       [=](PreviewOptions& o) { fresh(o), o.transparency = PreviewTransparency::Auto; }, all,
       &PreviewWork::eyeSegments, 0.01},
      {"layers where sorted lists are no larger", "shadow maps",
       [=](PreviewOptions& o) { fresh(o), o.visibility.layers = 0; }, all, &PreviewWork::mapSegments},
      {"two colour channels of grey hair", "shading",
       [=](PreviewOptions& o) { fresh(o), fibreOf(o, HairColor::Grey), o.fibre.absorption.setConstant(1); },
       all, &PreviewWork::scatterings},
      {"sub-frames of depth layers", "picture",
       [=](PreviewOptions& o) { fresh(o), o.transparency = PreviewTransparency::Auto; }, all,
       &PreviewWork::eyeSegments},
      {"strands and points that no one could tell", "picture", fresh,
       [](PreviewOptions& o) { o.lod = false; }, &PreviewWork::eyeSegments},
      {"maps and strands of a scene that stands still", "shadow maps", nothing,
       [](PreviewOptions& o) { o.keep = false; }, &PreviewWork::mapSegments},
      {"all shadows", "shadow maps", [=](PreviewOptions& o) { fresh(o), o.shadows = false; },
       [](PreviewOptions& o) { o.shadows = true; }, &PreviewWork::mapSegments},
  };
  list[0].keyLight = false;
  list[1].strands = list[2].strands = 2000;
  return list;
}

Spent spent(PreviewSession& session, const PreviewOptions& options, const Skip& skip) {
  const std::clock_t before = std::clock();
  const Picture picture = require(session.render(options));
  Spent out{double(std::clock() - before) / CLOCKS_PER_SEC, 0, double(picture.work.*skip.work)};
  for (const StageReport& report : picture.stages) {
    if (report.name == skip.stage) out.stage += report.seconds;
  }
  return out;
}

}  // namespace

BenchReport benchSkips(const BenchOptions& options) {
  BenchReport report;
  report.title = "What is left out";
  Result<Preview> preview = Preview::create();
  if (!preview.ok()) {
    report.about = "Nothing was measured: " + preview.error().text();
    return report;
  }
  const int side = options.quick ? 64 : 512;
  report.about =
      "Device: " + preview->renderer() +
      ". Each time without what a scene does not need over the time with it, in turns, the least of " +
      std::to_string(options.quick ? 1 : 3) + "; " + std::to_string(side) + " × " + std::to_string(side) +
      ". Pictures in processor time, their stages by the clock, their work counted where it is asked for.";
  const HairMesh mesh = previewProblemMesh(options);
  for (const Skip& skip : skips()) {
    const std::size_t strands = options.quick ? std::min<std::size_t>(skip.strands, 2000) : skip.strands;
    PreviewSession session = previewProblem(*preview, mesh, strands, 1, options, skip.width);
    Lights lights = fixedLights();
    if (!skip.keyLight) lights.key.color.setZero();
    session.setLights(lights);
    PreviewOptions without;
    without.width = without.height = side;
    without.measure = true;
    without.transparency = PreviewTransparency::DepthLayers;
    skip.scene(without);
    PreviewOptions with = without;
    skip.off(with);
    Spent least[2];
    for (int k = 0; k <= (options.quick ? 1 : 3); ++k) {
      for (const bool all : {true, false}) {
        const Spent now = spent(session, all ? with : without, skip);
        least[all].work = now.work;
        if (k == 0) continue;  // shaders
        least[all].picture = std::min(least[all].picture, now.picture);
        least[all].stage = std::min(least[all].stage, now.stage);
      }
    }
    for (const auto& [what, part] :
         {std::pair<std::string, double>("picture", least[0].picture / least[1].picture),
          {skip.stage + " alone", least[0].stage / least[1].stage},
          {"work of " + skip.stage, least[0].work / least[1].work}}) {
      const bool counted = what.starts_with("work");
      BenchFigure figure{skip.name + " left out: " + what, part, counted ? "of the count" : "of the time",
                         counted ? Bar::AtMost : Bar::None, kLessWork};
      if (options.onFigure) options.onFigure(figure);
      report.figures.push_back(std::move(figure));
    }
  }
  return report;
}

}  // namespace coif
