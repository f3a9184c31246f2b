// Moving a camera about a model: orbit, pan, dolly, the axis views. Plain functions; a view binds them to a
// mouse.
#pragma once

#include "coif/light/camera.h"

namespace coif {

/// Turns about the target. Positive azimuth moves the eye to its right, positive elevation up; elevation
/// stops at ±89°, so the view never rolls.
Camera orbit(const Camera& camera, UpAxis upAxis, double azimuthDeg, double elevationDeg);
/// Shifts eye and target in the picture's plane so that the target's depth moves by this many pixels of a
/// picture `height` pixels high; positive x right, positive y down, as a mouse drags the model.
Camera pan(const Camera& camera, double xPx, double yPx, int height);
/// Distance to the target times `factor` (> 0).
Camera dolly(const Camera& camera, double factor);
/// Angles that frameBox() was or would be given.
double azimuthDegOf(const Camera& camera, UpAxis upAxis);
double elevationDegOf(const Camera& camera, UpAxis upAxis);

/// A lens so long that it shows no perspective that a pixel could tell: what the orthographic views use.
inline constexpr double kParallelFovDeg = 0.5;
/// The same picture of the target's plane through another lens.
Camera withLens(const Camera& camera, double fovDeg);

}  // namespace coif
