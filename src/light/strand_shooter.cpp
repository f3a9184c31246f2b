#include "coif/light/strand_shooter.h"

#include <algorithm>
#include <cmath>

#include "light/ray_scene.h"

namespace coif {

double StrandMeeting::inclinationRad(const Vec3& direction) const {
  return std::asin(std::clamp(tangent.dot(direction), -1.0, 1.0));
}

struct StrandShooter::Impl {
  light::RayScene scene;
};

StrandShooter::StrandShooter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
StrandShooter::StrandShooter(StrandShooter&&) noexcept = default;
StrandShooter& StrandShooter::operator=(StrandShooter&&) noexcept = default;
StrandShooter::~StrandShooter() = default;

Result<StrandShooter> StrandShooter::create(const StrandSet& strands, const PolygonMesh* head) {
  COIF_ASSIGN(light::RayScene scene, light::RayScene::build(&strands, head));
  return StrandShooter(std::make_unique<Impl>(Impl{std::move(scene)}));
}

bool StrandShooter::shoot(const Vec3& origin, const Vec3& direction, double distance,
                          std::vector<StrandMeeting>& meetings, std::uint32_t leaving) const {
  return impl_->scene.all({origin, leaving, kNone}, direction, distance, meetings);
}

std::size_t StrandShooter::strandsDropped() const {
  return impl_->scene.strandsDropped();
}

}  // namespace coif
