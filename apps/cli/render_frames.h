// Pictures of hair in motion: which frames `coif render` makes, and where they come from.
#pragma once

#include <string>

#include "coif/scene/evaluate.h"
#include "command.h"

namespace coif::cli {

/// --frames, --motion, --fps. Frames count from 1, the first being the modelled style.
struct FrameArguments {
  std::string frames, motion;
  double framesPerSecond = 24;

  /// `alone`: the option that frames exclude.
  void addTo(CLI::App& command, CLI::Option* alone);
  bool asked() const { return !frames.empty() || !motion.empty(); }
  /// Those of --motion's cache, or simulated here as far as --frames asks. Errors: those of loadCache and
  /// simulate; InvalidArgument for a cache of another hair mesh or frames that it does not have.
  Result<DynamicsCache> load(const Scene& scene, Evaluation& evaluation, const Context& context) const;
  /// The frames asked for, from 0, one past the last; all of the motion without --frames.
  std::size_t first() const, end(const DynamicsCache&held) const;
};

}  // namespace coif::cli
