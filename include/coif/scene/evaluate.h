// The lazy stage graph: a stage runs only if its result is asked for and one of its inputs changed.
//
//   head ──────────────┐
//   hair mesh ─ place ─┴─ strands ─ export
#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "coif/base/context.h"
#include "coif/base/report.h"
#include "coif/io/strand_io.h"
#include "coif/place/place.h"
#include "coif/scene/scene.h"

namespace coif {

struct EvaluateOptions {
  PlaceOptions place;
  bool useHead = true;          ///< false: roots stay on the cage and the head is never read
  std::set<std::string> force;  ///< stages whose skipping and reuse are turned off ("all" for every one)
};

/// Names of the stages, in order.
inline constexpr const char* kStages[] = {"head", "check", "place", "strands", "export"};

/// Holds the results of the stages between calls, keyed by hashes of their inputs.
class Evaluation {
 public:
  explicit Evaluation(EvaluateOptions options = {});
  ~Evaluation();
  Evaluation(Evaluation&&) noexcept;

  /// The head as a surface; null when options.useHead is false. Errors: NotFound, … of loadPolygonMesh.
  Result<const Surface*> head(const Scene& scene, const Context& context = {});
  /// The hair mesh with internal vertices placed.
  Result<const HairMesh*> placedMesh(const Scene& scene, const Context& context = {});
  Result<const StrandSet*> strands(const Scene& scene, const Context& context = {});
  /// Writes strands, hair mesh and head to `path`; asks for whatever it needs.
  Result<WriteReport> exportTo(const Scene& scene, const std::filesystem::path& path, StrandExport what = {},
                               const Context& context = {});

  /// What each stage did, oldest first; cleared by clearReports().
  const std::vector<StageReport>& reports() const;
  void clearReports();
  const GrowReport* growReport() const;    ///< of the strands held; null when none
  const PlaceReport* placeReport() const;  ///< of the last solve; null when none ran

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A table for people (--explain) and JSON for programs (--report).
std::string explainText(const std::vector<StageReport>& reports);
std::string reportJson(const std::vector<StageReport>& reports);

}  // namespace coif
