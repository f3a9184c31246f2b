// A pinhole camera and how to frame a model with it.
#pragma once

#include "coif/base/result.h"
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

/// The camera's orthonormal frame, right × up = −forward, and the slope of the view's upper edge. Pixel (x,
/// y) of a width × height picture, rows from the top, looks along forward + slopeY ((2 x − width) right +
/// (height − 2 y) up) / height.
struct CameraFrame {
  Vec3 eye, right, up, forward;
  double slopeY = 0;  ///< tan(fov / 2)
};
/// Errors: InvalidArgument for a camera that is not finite, does not span a plane, or sees less than 0.01° or
/// 179° and more.
Result<CameraFrame> frameOf(const Camera& camera);

}  // namespace coif
