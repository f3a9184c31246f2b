// Frames along a strand: the root face's frame carried to the tip without twisting about the tangent.
#pragma once

#include <span>
#include <vector>

#include "coif/base/vec.h"

namespace coif {

/// Right-handed and orthonormal: binormal = tangent × normal.
struct Frame {
  Vec3 tangent = Vec3::UnitZ();
  Vec3 normal = Vec3::UnitX();
  Vec3 binormal = Vec3::UnitY();

  // Vectors along normal, binormal, tangent.
  Vec3 inSpace(const Vec3& o) const { return o.x() * normal + o.y() * binormal + o.z() * tangent; }
  Vec3 inFrame(const Vec3& v) const { return {normal.dot(v), binormal.dot(v), tangent.dot(v)}; }
};

/// Of a root face (>= 3 corners): the tangent is its Newell normal, the normal runs along its first side. A
/// face without an area gives the default frame.
Frame faceFrame(std::span<const Vec3> corners);

/// `frame` turned by the least rotation that brings its tangent to `tangent` (not zero; of any length).
/// Opposite tangents turn about the binormal.
Frame turnedTo(const Frame& frame, const Vec3& tangent);

/// One frame a point, out.size() == points.size(): the first is `root` turned to the curve's first tangent,
/// the others follow by double reflection (Wang, Jüttler, Zheng, Liu, "Computation of rotation minimizing
/// frames", ACM TOG 27, 2008, table I). Tangents are central differences; where one is zero (repeated points)
/// the previous frame is kept. No flip at inflections; global error O(h⁴) in the twist on a smooth curve. No
/// memory, linear.
void parallelTransport(std::span<const Vec3> points, const Frame& root, std::span<Frame> out);
void parallelTransport(std::span<const Vec3f> points, const Frame& root, std::span<Frame> out);

}  // namespace coif
