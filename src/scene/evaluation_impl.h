// What an Evaluation keeps between calls; its stages are in evaluate.cpp, style_stage.cpp and
// simulate_stage.cpp.
#pragma once

#include <optional>

#include "coif/io/skin_io.h"
#include "coif/scene/evaluate.h"
#include "coif/simulate/wisps.h"

namespace coif {

struct Evaluation::Impl {
  EvaluateOptions options;
  std::vector<StageReport> reports;

  std::filesystem::path headPath;
  std::filesystem::file_time_type headTime;
  std::uint64_t headHash = 0;
  bool headHeld = false;  // given, not read: the file is not looked at
  std::shared_ptr<const Surface> head;
  std::optional<std::uint64_t> checkedHash;
  std::optional<std::uint64_t> placeKey;  // of the scene's mesh, not of the placed one
  HairMesh placed;
  std::uint64_t placedHash = 0;
  std::optional<PlaceReport> placeReport;
  std::optional<std::uint64_t> strandsKey;
  GrowResult grown;
  std::optional<std::uint64_t> styleKey, motionStyleKey;
  StylePlan stylePlan;
  StrandSet styled;      // empty while the plan changes nothing
  StylePlan motionPlan;  // of strands with fixed points, where the scene's are adaptive
  std::optional<DynamicsCache> motion;
  std::optional<SimulationReport> simulationReport;
  struct Wisps {
    std::uint64_t key = 0;
    WispSet set;
    std::optional<std::uint64_t> boundKey;  // of the strands
    std::vector<WispStrand> bound;
  };
  std::optional<Wisps> wisps;

  bool forced(const char* stage) const {
    return options.force.contains(stage) || options.force.contains("all");
  }

  StageReport& add(const char* stage, StageState state, std::string reason, double seconds = 0,
                   std::uint64_t bytes = 0) {
    StageReport report;
    report.name = stage;
    report.state = state;
    report.reason = std::move(reason);
    report.seconds = seconds;
    report.bytes = bytes;
    return reports.emplace_back(std::move(report));
  }

  Status loadHead(const Scene& scene, const Context& context);
  Status check(const Scene& scene);
  Status runPlace(const Scene& scene, const Context& context);
  std::uint64_t strandsKeyOf(const Scene& scene) const;  // with the placed mesh and the head held
  Status growStrands(const Scene& scene, const Context& context);
  Status style(const Scene& scene, const Context& context);
  const StrandSet& strands() const { return stylePlan.changesNothing() ? grown.strands : styled; }
  /// The style of strands with fixed points, on the mesh at rest.
  Result<const StylePlan*> styleForMotion(const Scene& scene, const Context& context);
  Status simulate(const Scene& scene, const SimulateOptions& what, const Context& context);
  Status makeWisps(const Scene& scene, const Context& context);
  Result<StrandSet> carried(const Scene& scene, const DynamicsCache& motion, std::size_t frame,
                            const Context& context);

  struct Skin {
    std::optional<StrandSkin> binding;
    std::vector<std::string> notes;
  };
  /// Of the head's file, carried over to the strands; only USD files can hold it.
  Result<Skin> skinFor(const std::filesystem::path& output, const Context& context) const;
};

/// grow() as the scene asks for it.
GrowOptions growOptions(const Scene& scene, const Surface* head);

}  // namespace coif
