// Looks the map up at given points: for tests, and for measuring a method's error.
#include "hair_map_query.glsl"
layout(local_size_x = 64) in;
layout(std430, binding = 5) readonly buffer Points { vec4 points[]; };
layout(std430, binding = 6) writeonly buffer Answers { vec2 answers[]; };   // T; Ω of the first tap
layout(location = 0) uniform int count;
layout(location = 1) uniform int bilinear;
void main() {
  uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationID.x;
  if (i >= uint(count)) return;
  Taps taps = mapTaps(points[i].xyz, vec2(0), bilinear == 1);
  answers[i] = vec2(dot(taps.weights, exp(-taps.depths)), taps.depths.x);
}
