#include "coif/scene/seen_from_head.h"

namespace coif {

Camera cameraFromHead(const Camera& camera, const RigidPose& pose) {
  Camera seen = camera;
  seen.eye = pose.local(camera.eye);
  seen.target = pose.local(camera.target);
  seen.up = pose.rotation.transpose() * camera.up;
  return seen;
}

Lights lightsFromHead(const Lights& lights, const RigidPose& pose) {
  Lights seen = lights;
  if (lights.followCamera) return seen;
  for (Light* light : {&seen.key, &seen.fill, &seen.rim})
    light->direction = pose.rotation.transpose() * light->direction;
  return seen;
}

Ground groundFromHead(const Ground& ground, const RigidPose& pose) {
  Ground seen = ground;
  seen.point = pose.local(ground.point);
  seen.normal = pose.rotation.transpose() * ground.normal;
  return seen;
}

PolygonMesh headInWorld(const PolygonMesh& head, const RigidPose& pose) {
  PolygonMesh moved = head;
  for (Vec3& p : moved.positions) p = pose.world(p);
  return moved;
}

}  // namespace coif
