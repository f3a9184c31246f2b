// Every strand that a ray meets, in order: what global scattering by ray shooting counts on its way to a
// light.
//
// A ray meets a fibre where its line passes the axis of one of its segments within the radius (ends are
// rounded, so joints have no gaps), at the depth of the axis, however close the fibre is. The strand a ray
// leaves is not met before the ray has left the round fibre: 2 r / cos θ, 50 r at most.
#pragma once

#include <memory>
#include <vector>

#include "coif/base/result.h"
#include "coif/scalp/polygon_mesh.h"
#include "coif/strands/strand_set.h"

namespace coif {

/// One strand on the way of a ray of unit direction d.
struct StrandMeeting {
  std::uint32_t strand = kNone;  ///< index in the StrandSet
  std::uint32_t segment = 0;     ///< of the strand, from the root
  double along = 0;              ///< 0 … 1 on the segment
  double distance = 0;           ///< from the ray's origin, scene units
  Vec3 tangent = Vec3::UnitX();  ///< unit, root to tip
  double radius = 0;
  double h = 0;  ///< offset over the radius, −1 … 1, as fibre.h means it with ω_o = −d; seen along +d: −h

  /// Inclination of a direction to the fibre's normal plane, towards the tip: θ.
  double inclinationRad(const Vec3& direction) const;
};

/// Thread-safe queries against a set that is copied at the start. Double in, float inside: positions are good
/// to 1e-6 of the largest coordinate.
class StrandShooter {
 public:
  /// `head` may be null. Strands that are not drawable() or have no two distinct points are left out. Errors:
  /// what validate() refuses (numbers that are not finite in strands apart), TooLarge (2³² points or
  /// triangles), Unsupported (built without Embree). Cost: about a second for 3 million segments, on one
  /// thread so that the same rays meet the same segments on every machine's number of threads.
  static Result<StrandShooter> create(const StrandSet& strands, const PolygonMesh* head = nullptr);
  StrandShooter(StrandShooter&&) noexcept;
  StrandShooter& operator=(StrandShooter&&) noexcept;
  ~StrandShooter();

  /// What the ray from `origin` along `direction` (unit) meets before `distance` (infinity for a distant
  /// light) and before the head, nearest first, in `meetings` (cleared first; keeps its memory). Returns
  /// whether the head is in the way. From a point on a strand name it as `leaving`, so that it does not
  /// shadow itself; a curl that comes back does.
  bool shoot(const Vec3& origin, const Vec3& direction, double distance, std::vector<StrandMeeting>& meetings,
             std::uint32_t leaving = kNone) const;

  std::size_t strandsDropped() const;

 private:
  struct Impl;
  explicit StrandShooter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace coif
