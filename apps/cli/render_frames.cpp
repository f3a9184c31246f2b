#include "render_frames.h"

#include <cstdio>

#include "values.h"

namespace coif::cli {
namespace {

/// "A-B", or "B" for the first B.
bool parseFrames(const std::string& text, unsigned long& from, unsigned long& to) {
  int used = 0;
  const int size = int(text.size());
  if (std::sscanf(text.c_str(), "%7lu-%7lu%n", &from, &to, &used) != 2 || used != size) {
    from = 1;
    if (std::sscanf(text.c_str(), "%7lu%n", &to, &used) != 1 || used != size) return false;
  }
  return from >= 1 && to >= from && to <= 1000000;
}

std::string checkFrames(const std::string& text) {
  unsigned long from, to;
  return parseFrames(text, from, to) ? "" : "N or A-B, counted from 1, is wanted, not '" + text + "'";
}

}  // namespace

void FrameArguments::addTo(CLI::App& command, CLI::Option* alone) {
  command
      .add_option(
          "--frames", frames,
          "Hair in motion: the first N frames, or frames A-B, as FILE_0001.png …; simulated here unless "
          "--motion has them")
      ->check(CLI::Validator(checkFrames, "N|A-B"))
      ->excludes(alone);
  command.add_option("--motion", motion, "A .coifcache of this scene, as coif simulate writes it")
      ->excludes(alone);
  command.add_option("--fps", framesPerSecond, "Frames a second of what is simulated here")
      ->check(number(0.01, 1e5));
}

std::size_t FrameArguments::first() const {
  unsigned long from = 1, to = 1;
  if (!frames.empty()) parseFrames(frames, from, to);
  return from - 1;
}

std::size_t FrameArguments::end(const DynamicsCache& held) const {
  unsigned long from = 1, to = held.frameCount();
  if (!frames.empty()) parseFrames(frames, from, to);
  return to;
}

Result<DynamicsCache> FrameArguments::load(const Scene& scene, Evaluation& evaluation,
                                           const Context& context) const {
  if (motion.empty()) {
    SimulateOptions what;
    what.frames = end({});
    what.framesPerSecond = framesPerSecond;
    COIF_ASSIGN(const DynamicsCache* simulated, evaluation.simulate(scene, what, context));
    return *simulated;
  }
  COIF_ASSIGN(DynamicsCache cache, loadCache(motion));
  COIF_ASSIGN(const std::size_t points, evaluation.movedPoints(scene, context));
  if (cache.vertexCount != points)
    return makeError(ErrorCode::InvalidArgument,
                     "this motion is of another hair mesh, or of other wisps: it has " +
                         std::to_string(cache.vertexCount) + " points, the scene's has " +
                         std::to_string(points),
                     "", motion);
  if (end(cache) > cache.frameCount())
    return makeError(ErrorCode::InvalidArgument,
                     "this motion has " + std::to_string(cache.frameCount()) +
                         " frames, so there is no frame " + std::to_string(end(cache)),
                     "", motion);
  return cache;
}

}  // namespace coif::cli
