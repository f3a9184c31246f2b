// Hair on a round head: collisions with its signed distance, density repulsion, and air on demand.
#pragma once

#include <memory>
#include <optional>

#include "coif/simulate/collisions.h"
#include "coif/simulate/forces.h"
#include "coif/simulate/repulsion.h"
#include "coif/simulate/solver.h"

namespace coif {

/// `trees` chains of 0.3 m, standing off the upper part of a head of 0.1 m and falling over it.
class HeadProblem {
 public:
  struct Options {
    std::size_t trees = 100, links = 12;
    bool fluid = false;           ///< a wind of 2 m/s that head and hair stand in
    double stiffness = 0.25;      ///< of repulsion, as the square of a speed; 0: off
    double density = 0.5;         ///< pushed beyond this multiple of the greatest density at the start
    double headAway = 0;          ///< the head is this far off: nothing to collide with
    bool keepCollisions = false;  ///< in the solve though nothing is near
    int threads = 0;
  };
  explicit HeadProblem(const Options& options);

  StepReport step(double timeStep);
  const ChainState& state() const { return state_; }
  const CollisionField& collisions() const { return *collisions_; }

 private:
  Options options_;
  ChainSet chains_;
  ChainState state_;
  std::unique_ptr<Solver> solver_;
  std::optional<DistanceBand> band_;
  std::unique_ptr<CollisionField> collisions_;
  std::unique_ptr<RepulsionField> repulsion_;
  std::unique_ptr<Air> air_;
  std::unique_ptr<DragField> drag_;
  std::unique_ptr<ForceField> kept_;
  std::vector<ForceField*> fields_;
};

}  // namespace coif
