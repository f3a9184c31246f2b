// A pinhole camera and how to frame a model with it.
#pragma once

#include "coif/base/vec.h"
#include "coif/scalp/polygon_mesh.h"

namespace coif {

/// Perspective camera in scene units; eye, target and up must be finite and span a plane. fovDeg is the
/// vertical angle of view, in (0, 180).
struct Camera {
  Vec3 eye = Vec3(0, 0, 1);
  Vec3 target = Vec3::Zero();
  Vec3 up = Vec3::UnitY();
  double fovDeg = 30;
};

/// A camera that sees the whole box at the picture's `aspect` (width / height). Azimuth 0 looks at the front
/// (+z of a y-up model, -y of a z-up one), positive azimuth moves the camera to +x; elevation is up, within
/// ±89°.
Camera frameBox(const Box& box, UpAxis upAxis, double azimuthDeg, double elevationDeg, double aspect = 1);

}  // namespace coif
