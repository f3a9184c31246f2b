// Rays against strands and an opaque head: what the path tracer and the strand shooter share (Embree inside).
// The rules of meeting a fibre are those of strand_shooter.h.
#pragma once

#include "coif/light/strand_shooter.h"

namespace coif::light {

/// Where a ray starts, and what it just left.
struct RayStart {
  Vec3 origin = Vec3::Zero();
  std::uint32_t strand = kNone;
  std::uint32_t triangle = kNone;  ///< of the head; never met again by this ray
};

struct RayHit {
  enum class Kind { Nothing, Strand, Head } kind = Kind::Nothing;
  double distance = 0;
  StrandMeeting strand;
  Vec3 faceNormal = Vec3::Zero(), smoothNormal = Vec3::Zero();  ///< of the head, unit, outwards
  std::uint32_t triangle = kNone;
};

class RayScene {
 public:
  /// Either may be null. Errors as StrandShooter::create.
  static Result<RayScene> build(const StrandSet* strands, const PolygonMesh* head);
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;
  ~RayScene();

  /// `direction` unit. Thread-safe, as all queries.
  RayHit closest(const RayStart& start, const Vec3& direction) const;
  bool blocked(const RayStart& start, const Vec3& direction, double distance) const;
  bool all(const RayStart& start, const Vec3& direction, double distance,
           std::vector<StrandMeeting>& meetings) const;

  std::size_t strandsDropped() const;

  struct Impl;

 private:
  explicit RayScene(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace coif::light
