#include "coif/scene/new_scene.h"

#include <cmath>
#include <numbers>

namespace coif {
namespace {

constexpr double kHeadMeters = 0.24;  // a head 24 cm tall, where a file says nothing of its unit

/// Where the face looks, as an azimuth of the camera: 0 is +z of a y-up model, −y of a z-up one.
double frontAzimuthDeg(const HeadFrame& frame, UpAxis up) {
  const double depth = up == UpAxis::Y ? frame.forward.z() : -frame.forward.y();
  return std::atan2(frame.forward.x(), depth) * 180 / std::numbers::pi;
}

}  // namespace

Result<Scene> sceneOnHead(const std::filesystem::path& headFile, const PolygonMesh& head, const Cage& cage,
                          Hairstyle hairstyle, std::optional<double> metersPerUnit) {
  Scene scene;
  scene.head.path = std::filesystem::absolute(headFile);
  COIF_ASSIGN(scene.head.contentHash, fileHash(headFile));
  scene.metersPerUnit = metersPerUnit            ? *metersPerUnit
                        : head.metersPerUnit > 0 ? head.metersPerUnit
                        : cage.frame.height > 0  ? kHeadMeters / cage.frame.height
                                                 : 0.01;
  scene.upAxis = head.upAxis;
  scene.look.azimuthDeg = hairstyle.showFromDeg + frontAzimuthDeg(cage.frame, head.upAxis);
  scene.hairMesh = std::move(hairstyle.mesh);
  scene.placedHash = meshHash(scene.hairMesh);
  return scene;
}

Result<Hairstyle> bareRoots(const Cage& cage) {
  Hairstyle bare;
  COIF_ASSIGN(bare.mesh, HairMesh::fromRoot(cage.positions, cage.faceOffsets, cage.corners));
  return bare;
}

}  // namespace coif
