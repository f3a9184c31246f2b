// The uniform block `Frame` of shaders/frame.glsl, and the camera and lights worked out for one picture.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "coif/preview/preview.h"

namespace coif::preview {

using Vec4f = Eigen::Vector4f;
using Mat4f = Eigen::Matrix4f;

/// Field by field the std140 layout of the block (vec4s and column-major mat4s only).
struct FrameData {
  Mat4f clipFromWorld;
  Vec4f eye, viewForward, viewUp, viewport;
  Vec4f lightDirection[3], lightColor[3];
  Vec4f skyColor, groundColor;
  Vec4f volumeLo, volumeScale;
  Vec4f shadowInfo;
  Vec4f hairColor, headColor, hairPasses, backgroundTop, backgroundBottom;
};
static_assert(sizeof(FrameData) == 16 * (4 + 4 + 6 + 2 + 2 + 1 + 5), "as std140 lays it out");

/// The camera's orthonormal frame and what a pixel measures.
struct View {
  Vec3 eye, right, up, forward;
  Vec3 cameraUp;                     ///< as the camera has it, unit: not tilted with the view
  double pixelAtOne = 0;             ///< world size of a pixel at distance 1
  double nearest = 0, farthest = 0;  ///< depth range that holds the scene
  int width = 0, height = 0;

  double pixelAt(const Vec3& p) const { return pixelAtOne * std::max((p - eye).dot(forward), nearest); }
};

/// Errors: InvalidArgument for a camera that is not finite or does not span a plane.
Result<View> makeView(const Camera& camera, const Box& scene, int width, int height);

/// View, projection, lights and colours; shadows and volume are left empty. `jitter` in pixels.
FrameData makeFrame(const View& view, const Lights& lights, const PreviewOptions& options);
/// Copies what a shadow pass fills.
void copyShadowFields(const FrameData& from, FrameData& to);
Mat4f clipFromWorld(const View& view, const Vec2& jitter);

/// A point of low discrepancy in [-1/2, 1/2)², the first at the pixel's middle.
Vec2 subframeJitter(int subframe, int count);

}  // namespace coif::preview
