// The lazy stage graph: a stage runs only if its result is asked for and one of its inputs changed.
//
//   head ──────────────┐
//   hair mesh ─ place ─┼─ strands ─ style ─ export
//                      └─ simulate ─ strands of a frame
#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "coif/base/context.h"
#include "coif/base/report.h"
#include "coif/io/strand_io.h"
#include "coif/place/place.h"
#include "coif/scene/dynamics_cache.h"
#include "coif/scene/scene.h"
#include "coif/simulate/simulation.h"
#include "coif/style/style_plan.h"

namespace coif {

struct EvaluateOptions {
  PlaceOptions place;
  bool useHead = true;          ///< false: roots stay on the cage and the head is never read
  std::set<std::string> force;  ///< stages whose skipping and reuse are turned off ("all" for every one)
};

/// What `simulate` is asked for; how hair moves is the scene's own (Scene::dynamics).
struct SimulateOptions {
  std::size_t frames = 24;  ///< the first is the modelled style, settled as the scene says
  double framesPerSecond = 24;
  HeadMotion motion;
  /// A .coifcache that is gone on with if it is of the same simulation, and kept up to date on the way;
  /// empty: none.
  std::filesystem::path cache;
};

/// A head as it was read, for all that look at it.
struct LoadedHead {
  std::shared_ptr<const Surface> surface;  ///< null: none
  std::filesystem::path path;
  std::uint64_t hash = 0;  ///< fileHash of the file
};
/// Errors: NotFound, … of loadPolygonMesh; Cancelled. Cost: reading, and Surface's.
Result<LoadedHead> loadHead(const std::filesystem::path& path, const Context& context = {});

/// Names of the stages, in order.
inline constexpr const char* kStages[] = {"head", "check", "place", "strands", "style", "simulate", "export"};

/// Holds the results of the stages between calls, keyed by hashes of their inputs.
class Evaluation {
 public:
  explicit Evaluation(EvaluateOptions options = {});
  ~Evaluation();
  Evaluation(Evaluation&&) noexcept;

  /// Scenes on this file's head take it as it is here, without reading the file (again).
  void holdHead(LoadedHead head);
  /// The head as a surface; null when options.useHead is false. Errors: NotFound, … of loadPolygonMesh.
  Result<const Surface*> head(const Scene& scene, const Context& context = {});
  /// The hair mesh with internal vertices placed.
  Result<const HairMesh*> placedMesh(const Scene& scene, const Context& context = {});
  /// Styled, as they are shown and exported.
  Result<const StrandSet*> strands(const Scene& scene, const Context& context = {});
  /// As the hair mesh has them: the stack is not looked at.
  Result<const StrandSet*> grownStrands(const Scene& scene, const Context& context = {});
  /// Hair in motion: at least the frames asked for. Reused when nothing changed, gone on with from memory or
  /// from the cache file when more frames are wanted. Errors also those of Simulation and of the file; a
  /// cache of another simulation is an error, never overwritten.
  Result<const DynamicsCache*> simulate(const Scene& scene, const SimulateOptions& what,
                                        const Context& context = {});
  /// How many points a frame of the scene's motion has: the placed mesh's vertices, or with wisps their
  /// guides' points.
  Result<std::size_t> movedPoints(const Scene& scene, const Context& context = {});
  /// The hair mesh on a frame of `motion`, in the head's own frame: DynamicsCache::poses says where that is.
  /// Errors: InvalidArgument for a frame that it does not have, another mesh, or wisps, which move no mesh.
  Result<HairMesh> meshAt(const Scene& scene, const DynamicsCache& motion, std::size_t frame,
                          const Context& context = {});
  /// The strands on a frame of `motion`, the same strands on each: grown in the head's own frame, where its
  /// roots are at rest, or carried by the scene's wisps. Fixed points a strand, whatever the scene's
  /// tolerance. With a deforming scalp roots follow the cage, or their wisp's guides, alone. Errors: those of
  /// meshAt.
  Result<StrandSet> strandsAt(const Scene& scene, const DynamicsCache& motion, std::size_t frame,
                              const Context& context = {});
  /// Writes all frames as USD time samples (.usda, .usdc): points of the strands, transform of a head that
  /// moves. Simulates first.
  Result<WriteReport> exportMotion(const Scene& scene, const SimulateOptions& what,
                                   const std::filesystem::path& path, const Context& context = {});
  /// Lets the scene's hair mesh hang under gravity and counts it as placed: a modelling step.
  Result<DrapeReport> drape(Scene& scene, const DrapeOptions& options = {}, const Context& context = {});
  /// Writes strands, hair mesh and head to `path`; asks for whatever it needs.
  Result<WriteReport> exportTo(const Scene& scene, const std::filesystem::path& path, StrandExport what = {},
                               const Context& context = {});

  /// What each stage did, oldest first; cleared by clearReports().
  const std::vector<StageReport>& reports() const;
  void clearReports();
  const GrowReport* growReport() const;  ///< of the strands held; null when none
  /// What the style does to the strands held; null when it does nothing or has not been asked for.
  const StylePlan* stylePlan() const;
  const PlaceReport* placeReport() const;            ///< of the last solve; null when none ran
  const SimulationReport* simulationReport() const;  ///< of the frames computed last; null when none

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A table for people (--explain) and JSON for programs (--report).
std::string explainText(const std::vector<StageReport>& reports);
std::string reportJson(const std::vector<StageReport>& reports);

}  // namespace coif
