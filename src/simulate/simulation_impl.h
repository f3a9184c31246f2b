// What a Simulation holds between frames.
#pragma once

#include <optional>

#include "coif/simulate/collisions.h"
#include "coif/simulate/forces.h"
#include "coif/simulate/repulsion.h"
#include "coif/simulate/simulation.h"
#include "coif/simulate/wisps.h"
#include "simulate/root_motion.h"

namespace coif {

struct Simulation::Impl {
  HairMesh mesh;
  DynamicsSettings settings;
  SimulationWorld world;
  simulate::RootPath path;
  std::optional<WispSet> wisps;  // else the chains are the mesh's
  ChainBuild build;
  std::unique_ptr<Solver> solver;
  ChainState state;
  std::size_t frame = 0;
  std::vector<Vec3> positions;

  std::shared_ptr<const DistanceBand> band;
  std::vector<std::unique_ptr<Collider>> capsules;
  std::vector<std::uint8_t> withHead;  // by collider of the collision field
  std::unique_ptr<CollisionField> collisions;
  std::unique_ptr<Air> air;
  FluidWind* fluid = nullptr;  // the air, when it is one
  std::unique_ptr<DragField> drag;
  std::unique_ptr<RepulsionField> repulsion;
  std::vector<ForceField*> fields;
  std::vector<Vec3> rootPositions;
  std::vector<Mat3> rootFrames;
  SimulationReport report;
  double newtonSum = 0;

  double stepSeconds() const { return 1 / (world.framesPerSecond * report.stepsPerFrame); }
  double perUnit() const { return 1 / world.metersPerUnit; }
  Vec3 up() const { return world.upAxis == UpAxis::Z ? Vec3(Vec3::UnitZ()) : Vec3(Vec3::UnitY()); }

  Status makeChains(const Context& context);
  void addWispSprings();
  /// Where a vertex of the scalp, or with wisps a guide's first point, is at `time` in frames.
  void rootAt(std::uint32_t source, double time, Vec3& position, Mat3& turn) const;
  Status makeCollisions(const Context& context);
  Status makeAir();
  void makeRepulsion();
  void addField(ForceField* field, const char* name);
  void start();
  void moveRoots(double time);
  Status step(double from, double to, double timeStep, const Context& context);
  void gather();
  void count(const StepReport& stepReport);
};

}  // namespace coif
