#include "coif/strands/strand_style.h"

#include <cmath>

namespace coif {

Vec3 firstTangent(std::span<const Vec3f> points) {
  for (std::size_t p = 0; p + 1 < points.size(); ++p) {
    const Vec3 step = points[p + 1].cast<double>() - points[p].cast<double>();
    if (step.norm() > 0) return step.normalized();
  }
  return Vec3::Zero();
}

std::vector<Frame> rootFaceFrames(const HairMesh& mesh) {
  std::vector<Frame> frames;
  for (const Bundle& bundle : mesh.bundles()) {
    std::vector<Vec3> corners;
    for (const std::uint32_t v : bundle.face(0)) corners.push_back(mesh.position(v));
    frames.push_back(faceFrame(corners));
  }
  return frames;
}

Frame rootFrame(const Frame& face, std::span<const Vec3f> points, float turn) {
  const Vec3 tangent = firstTangent(points);
  if (tangent.isZero(0)) return face;
  const Frame frame = turnedTo(face, tangent);
  Frame out = frame;
  out.normal = std::cos(double(turn)) * frame.normal + std::sin(double(turn)) * frame.binormal;
  out.binormal = out.tangent.cross(out.normal);
  return out;
}

Vec3 styledPoint(const StrandCurve& curve, double place, const Vec3& offset) {
  const Vec3 position = curve.position(place);
  return offset.isZero(0) ? position : Vec3(position + curve.frame(place).inSpace(offset));
}

}  // namespace coif
