#include <algorithm>
#include <cmath>

#include "coif/simulate/simulation.h"

namespace coif {

namespace {
constexpr double kFramesPerSecond = 24;
// Hair comes to rest in a few oscillations of a column at this drag; the hang does not depend on it.
constexpr double kDrag = 6;
}  // namespace

Result<DrapeReport> drape(HairMesh& mesh, const DynamicsSettings& settings, const SimulationWorld& world,
                          const DrapeOptions& options, const Context& context) {
  if (!(options.seconds > 0 && options.seconds <= 3600) || !(options.tolerance >= 0))
    return makeError(ErrorCode::InvalidArgument,
                     "draping takes a time above 0 and at most an hour, and a tolerance of 0 or more");
  DynamicsSettings calm = settings;
  calm.wind = WindKind::None;
  calm.settleSeconds = 0;
  calm.wisps = 0;  // it is the mesh that keeps the shape
  calm.drag = std::max(settings.drag, kDrag);
  SimulationWorld still = world;
  still.motion = {};
  still.framesPerSecond = kFramesPerSecond;
  COIF_ASSIGN(const auto simulation, Simulation::create(mesh, calm, still, context));
  std::vector<Vec3> last(simulation->positions().begin(), simulation->positions().end());
  const std::vector<Vec3> first = last;
  const double box = bounds(last).diagonal();
  const auto greatest = [&](const std::vector<Vec3>& from) {
    double most = 0;
    for (std::size_t v = 0; v < from.size(); ++v)
      most = std::max(most, (simulation->positions()[v] - from[v]).norm());
    return most;
  };
  DrapeReport report;
  const auto frames = std::size_t(std::ceil(options.seconds * kFramesPerSecond));
  while (report.frames < frames && !report.settled) {
    context.report("draping", double(report.frames) / double(frames));
    COIF_TRY(simulation->advance(context));
    ++report.frames;
    report.lastMove = greatest(last);
    last.assign(simulation->positions().begin(), simulation->positions().end());
    // The first frames, when everything still gathers speed, move little too.
    report.settled = report.frames > 12 && report.lastMove <= options.tolerance * box;
  }
  report.greatestMove = greatest(first);
  report.simulation = simulation->report();
  report.leftOut = simulation->leftOut();
  for (std::size_t v = 0; v < last.size(); ++v) {
    if (mesh.vertices()[v].layer > 0) mesh.setPosition(std::uint32_t(v), last[v]);
  }
  return report;
}

}  // namespace coif
