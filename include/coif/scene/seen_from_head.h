// A moving head stands still in its own frame: what is seen and lit from there, for pictures whose strands'
// roots stay where they are on the head.
#pragma once

#include "coif/light/camera.h"
#include "coif/light/ground.h"
#include "coif/light/lights.h"
#include "coif/simulate/collider.h"

namespace coif {

Camera cameraFromHead(const Camera& camera, const RigidPose& pose);
/// Distant lights that stand in the scene are turned; those that follow the camera stay as they are.
Lights lightsFromHead(const Lights& lights, const RigidPose& pose);
Ground groundFromHead(const Ground& ground, const RigidPose& pose);
/// The other way: the head where it is.
PolygonMesh headInWorld(const PolygonMesh& head, const RigidPose& pose);

}  // namespace coif
