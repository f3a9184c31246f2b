// Options that several subcommands put on a scene.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "coif/scene/evaluate.h"
#include "command.h"

namespace coif::cli {

/// --strands, --points, --tolerance, --seed, --width: what the document says unless given.
struct StrandArguments {
  std::optional<std::uint64_t> count, seed;
  std::optional<std::uint32_t> points;
  std::optional<double> tolerance, width;

  void addTo(CLI::App& command);
  void apply(Scene& scene) const;
};

/// --solver, --wind, --wisps, --precision, --set: how hair moves, instead of what the document says.
struct DynamicsArguments {
  std::vector<std::pair<std::string, std::string>> named;  ///< a setting's name and its value
  std::vector<std::string> set;                            ///< "NAME=VALUE"

  void addTo(CLI::App& command);
  Status apply(Scene& scene) const;
};

/// --explain, --report, --force, --no-head.
struct EvaluateArguments {
  bool explain = false, noHead = false;
  std::string reportFile;
  std::vector<std::string> force;

  void addTo(CLI::App& command);
  EvaluateOptions options() const;
  /// Whether the report can be written, asked before the work.
  Status canTell() const;
  /// What --explain and --report ask for.
  Status tell(const std::vector<StageReport>& stages, const Session& session) const;
};

}  // namespace coif::cli
