// Coverage of strands by compute alone: adds optical depth with 32-bit atomics, so that hairs may come in any order:
// 1 − exp(−Σ) is the coverage. With NEAREST the nearest depth as well.
#define COMPUTE
#include "frame.glsl"
#include "strand_buffer.glsl"
#include "strand_walk.glsl"
layout(local_size_x = 64) in;
layout(std430, binding = 1) buffer Depths { uint opticalDepth[]; };  // in units of kUnit
layout(std430, binding = 2) buffer Nearest { uint nearest[]; };
layout(location = 0) uniform uint pointCount;
const float kUnit = 1.0 / 16384.0;

void put(ivec2 pixel, float area, float depth, float along) {
  uint index = uint(pixel.y) * uint(viewport.x) + uint(pixel.x);
  atomicAdd(opticalDepth[index], uint(opticalDepthOf(area) / kUnit + 0.5));
#ifdef NEAREST
  atomicMin(nearest[index], floatBitsToUint(depth));  // positive floats order as their bits do
#endif
}

void main() {
  uint point = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationID.x;
  if (point + 1u < pointCount) walkSegment(point, 0, int(viewport.y));
}
