#include "preview/frame_data.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace coif::preview {
namespace {

Vec4f vec4(const Vec3& v, double w = 0) {
  return Vec4f(float(v.x()), float(v.y()), float(v.z()), float(w));
}
Vec4f vec4(const Vec3f& v, float w = 0) {
  return Vec4f(v.x(), v.y(), v.z(), w);
}

}  // namespace

Result<View> makeView(const Camera& camera, const Box& scene, int width, int height) {
  COIF_ASSIGN(const CameraFrame frame, frameOf(camera));
  View view;
  view.eye = frame.eye;
  view.forward = frame.forward;
  view.right = frame.right;
  view.up = frame.up;
  view.cameraUp = camera.up.normalized();
  view.width = width;
  view.height = height;
  view.pixelAtOne = 2 * frame.slopeY / height;
  double nearest = INFINITY, farthest = 0;
  for (int c = 0; c < 8; ++c) {
    const Vec3 corner((c & 1 ? scene.hi : scene.lo).x(), (c & 2 ? scene.hi : scene.lo).y(),
                      (c & 4 ? scene.hi : scene.lo).z());
    const double depth = (corner - view.eye).dot(view.forward);
    nearest = std::min(nearest, depth);
    farthest = std::max(farthest, depth);
  }
  const double size = std::max({scene.diagonal(), 1e-6 * view.eye.norm(), 1e-9});
  view.farthest = std::max(farthest, 0.0) + 0.02 * size;
  view.nearest = std::clamp(nearest - 0.02 * size, 1e-3 * size, 0.9 * view.farthest);
  return view;
}

Mat4f clipFromWorld(const View& view, const Vec2& jitter) {
  const double f = 2 / (view.pixelAtOne * view.height);  // cot(fov / 2)
  const double n = view.nearest, r = view.farthest;
  Eigen::Matrix4d camera = Eigen::Matrix4d::Identity(), projection = Eigen::Matrix4d::Zero();
  camera.row(0).head<3>() = view.right;
  camera.row(1).head<3>() = view.up;
  camera.row(2).head<3>() = -view.forward;
  camera.block<3, 1>(0, 3) = -camera.topLeftCorner<3, 3>() * view.eye;
  projection(0, 0) = f * view.height / view.width;
  projection(1, 1) = f;
  projection(0, 2) = -2 * jitter.x() / view.width;  // w = -z
  projection(1, 2) = -2 * jitter.y() / view.height;
  projection(2, 2) = -(r + n) / (r - n);
  projection(2, 3) = -2 * r * n / (r - n);
  projection(3, 2) = -1;
  return (projection * camera).cast<float>();
}

Vec2 subframeJitter(int subframe, int count) {
  if (count <= 1) return Vec2::Zero();
  // Roberts' R2 sequence.
  const double x = 0.5 + 0.7548776662466927 * subframe, y = 0.5 + 0.5698402909980532 * subframe;
  return {x - std::floor(x) - 0.5, y - std::floor(y) - 0.5};
}

FrameData makeFrame(const View& view, const Lights& lights, const PreviewOptions& options) {
  FrameData frame;
  std::fill_n(reinterpret_cast<float*>(&frame), sizeof(FrameData) / sizeof(float), 0.0f);
  frame.clipFromWorld = clipFromWorld(view, Vec2::Zero());
  frame.eye = vec4(view.eye, view.pixelAtOne);
  frame.viewForward = vec4(view.forward, view.nearest);
  frame.viewUp = vec4(lights.followCamera ? view.up : view.cameraUp);  // the middle of the sky
  frame.viewport =
      Vec4f(float(view.width), float(view.height), 0, options.transparentBackground ? 1.0f : 0.0f);
  const Light* three[] = {&lights.key, &lights.fill, &lights.rim};
  for (int l = 0; l < 3; ++l) {
    frame.lightDirection[l] =
        vec4(towardsLight(*three[l], lights.followCamera, view.right, view.up, view.forward));
    frame.lightColor[l] = vec4(three[l]->color);
  }
  frame.skyColor = vec4(lights.skyColor);
  frame.groundColor = vec4(lights.groundColor);
  frame.hairColor = vec4(options.hairColor);
  frame.headColor = vec4(options.headColor);
  frame.hairPasses.setZero();
  frame.backgroundTop = vec4(options.backgroundTop);
  frame.backgroundBottom = vec4(options.backgroundBottom);
  return frame;
}

void copyShadowFields(const FrameData& from, FrameData& to) {
  to.volumeLo = from.volumeLo;
  to.volumeScale = from.volumeScale;
  to.shadowInfo = from.shadowInfo;
}

}  // namespace coif::preview
