// A hairstyle in motion: hair mesh, settings, head and its motion in; positions of the mesh's vertices, frame
// by frame, out, or those of wisps' guides. Strands follow the mesh by themselves, wisps by carryStrands().
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "coif/base/context.h"
#include "coif/base/report.h"
#include "coif/base/result.h"
#include "coif/hairmesh/hair_mesh.h"
#include "coif/scalp/surface.h"
#include "coif/simulate/collider.h"
#include "coif/simulate/dynamics_settings.h"

namespace coif {

/// How the scalp moves, by frame; between frames linearly and on great circles, after the last it stays.
/// Either poses of the head as a whole relative to the model, or positions of all layer-0 vertices
/// (ascending by index) for a skinned or deforming scalp. Both empty: it stays where it was modelled.
struct HeadMotion {
  std::vector<RigidPose> poses;
  std::vector<std::vector<Vec3>> roots;
};

struct SimulationWorld {
  const Surface* head = nullptr;  ///< at rest; must outlive the simulation; may be null
  double metersPerUnit = 0.01;
  UpAxis upAxis = UpAxis::Y;
  HeadMotion motion;
  double framesPerSecond = 24;
  /// The head's distances as an earlier Simulation measured them: used where they reach far enough.
  std::shared_ptr<const DistanceBand> band = {};
};

struct FieldUse {
  std::string name;
  std::size_t steps = 0;   ///< in which it acted
  std::string idleReason;  ///< why not in the last step that it was left out of; empty: it always acted
};

struct SimulationReport {
  std::size_t vertices = 0, chains = 0, links = 0;
  std::size_t frames = 0, steps = 0;  ///< done by this object
  int stepsPerFrame = 0;
  double seconds = 0;
  std::size_t chainSteps = 0;          ///< solved, summed over steps
  std::size_t asleep = 0;              ///< chains left as they were, summed over steps
  std::size_t limp = 0, inSingle = 0;  ///< chains without bending terms, chains in single precision
  int maxNewton = 0;
  double meanNewton = 0;           ///< of a chain that is solved
  std::size_t resets = 0;          ///< chains that were not finite and were reset, summed over steps
  std::size_t unconverged = 0;     ///< chains that kept their best iterate, summed over steps
  double maxStretch = 0;           ///< greatest relative length error of a link, over all frames
  std::size_t collidingNodes = 0;  ///< looked at, greatest of a step
  DistanceBandReport band;         ///< of the head
  std::vector<FieldUse> fields;
};

class Simulation {
 public:
  /// Frame 0 is the modelled mesh where the motion begins, after settleSeconds. Errors: InvalidArgument
  /// (settings out of range, frames a second not in (0, 100 000], motion of the wrong size or not finite),
  /// Degenerate (no column of any length, a mesh or head that is not finite), Cancelled. Cost: the head's
  /// distances, once.
  static Result<std::unique_ptr<Simulation>> create(const HairMesh& mesh, const DynamicsSettings& settings,
                                                    const SimulationWorld& world,
                                                    const Context& context = {});
  ~Simulation();

  std::size_t frame() const;  ///< where it is
  /// Of every vertex of the mesh there, scene units; with wisps, of every guide's points (WispSet::guides).
  std::span<const Vec3> positions() const;
  RigidPose pose() const;  ///< of the head there; with roots given, the best rigid fit
  /// One frame on. Chains that fail are reset and counted. Errors: Cancelled, with the frame as it was.
  Status advance(const Context& context = {});

  /// All that advance() changes: restored into a Simulation of the same inputs, it goes on with the same
  /// bytes.
  std::vector<std::byte> state() const;
  /// Errors: Malformed; then nothing changed.
  Status restore(std::span<const std::byte> state);

  const SimulationReport& report() const;
  /// What the frames so far did not need, with its switch and trigger.
  std::vector<LeftOut> leftOut() const;
  /// The head's distances, for the next Simulation of the same head; null without collisions.
  std::shared_ptr<const DistanceBand> band() const;

 private:
  struct Impl;
  explicit Simulation(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

struct DrapeOptions {
  double seconds = 10;      ///< at most
  double tolerance = 1e-4;  ///< stop when no vertex moves further in 1/24 s than this fraction of the box
};
struct DrapeReport {
  std::size_t frames = 0;
  bool settled = false;     ///< the tolerance was reached
  double greatestMove = 0;  ///< of any vertex, scene units
  double lastMove = 0;      ///< in the last 1/24 s
  SimulationReport simulation;
  std::vector<LeftOut> leftOut;
};
/// Lets the mesh hang under gravity until it rests and leaves its vertices there: a modelling operation, for
/// History::apply. Roots stay; lengths of columns are kept. Wind and head motion are left out. Errors: those
/// of Simulation::create; the mesh is then unchanged.
Result<DrapeReport> drape(HairMesh& mesh, const DynamicsSettings& settings, const SimulationWorld& world,
                          const DrapeOptions& options = {}, const Context& context = {});

}  // namespace coif
