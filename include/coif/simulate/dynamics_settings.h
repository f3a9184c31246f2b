// How a hairstyle moves: what the document keeps and a Simulation is made from.
#pragma once

#include <vector>

#include "coif/base/vec.h"
#include "coif/simulate/solver.h"

namespace coif {

enum class WindKind { None, Constant, Gusts, Fluid };

/// A solid beside the head: all points within `radius` of the segment a–b (a sphere where a = b). Scene
/// units.
struct BodyCapsule {
  Vec3 a = Vec3::Zero(), b = Vec3::Zero();
  double radius = 0;
  bool withHead = true;  ///< moves with the head; else it stays
  bool operator==(const BodyCapsule&) const = default;
};

/// Metres and seconds, whatever the scene's unit, so that settings travel between scenes; capsules alone are
/// in scene units.
struct DynamicsSettings {
  DynamicsMethod method = DynamicsMethod::Direct;
  double longestStep = 1.0 / 120;  ///< frames are cut into steps at most this long
  /// Newton stops once what is left would move no node by more than this fraction of the mean link: far
  /// below a tenth of a pixel. 0: to rounding.
  double tolerance = 1e-6;
  bool singlePrecision = false;  ///< SolverOptions::floatLanes
  bool skipBending = true;       ///< SolverOptions::skipBending
  /// Chains that were slower than sleepSpeed (m/s) for sleepSeconds are left as they are until something
  /// moves or pulls them. 0: never.
  double sleepSpeed = 1e-4, sleepSeconds = 0.1;
  double settleSeconds = 0;  ///< time before the first frame in which hair finds its hang

  /// What is simulated: the columns of the hair mesh, or so many wisps of three guides each (wisps.h).
  std::size_t wisps = 0;
  std::uint32_t guidePoints = 12;  ///< of a guide

  double gravity = 9.81;  ///< against the up axis
  /// How far a column held level droops under its weight, as a fraction of its length; 0: limp.
  double droop = 0.3;
  double lateral = 0;  ///< stiffness of side quads over a column's weight a unit length, 1/s²; 0: none
  double drag = 2;     ///< of air, per second

  WindKind wind = WindKind::None;
  Vec3 windVelocity = Vec3::Zero();  ///< mean
  double gustSpeed = 2, gustSize = 0.2, gustSeconds = 0.5;
  std::uint64_t seed = 1;
  int airCells = 24;     ///< of the fluid, along its longest side
  double shelter = 100;  ///< rate at which the densest hair takes the air along, per second

  bool collide = true;            ///< with the head and the capsules
  double thickness = 0.004;       ///< of hair over the skin; less where it was modelled closer
  double contactStiffness = 1e5;  ///< per second²
  double friction = 0.3;
  std::vector<BodyCapsule> capsules;

  double repulsion = 0;     ///< speed at which pressed hair pushes back; 0: off
  double density = 1;       ///< pushed beyond this multiple of the modelled style's greatest density
  double cell = 0.015;      ///< of the density grid
  double hairFriction = 0;  ///< rate at which neighbours drag each other along, per second

  bool operator==(const DynamicsSettings&) const = default;
};

/// Refuses what is not finite or out of range, naming the setting.
Status validate(const DynamicsSettings& settings);

}  // namespace coif
