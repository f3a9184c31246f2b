// Ribbons that face the key light, at least a texel wide.
#include "frame.glsl"
#include "strand_buffer.glsl"
out float coverage;
void main() {
  StrandPoint p = strandPointAt(gl_VertexID >> 1);
  float ribbon = max(p.positionWidth.w, shadowInfo.z);
  coverage = p.positionWidth.w / ribbon;
  vec3 side = cross(p.tangentSeed.xyz, lightDirection[0].xyz);
  float sideLength = length(side);
  side = sideLength > 1e-6 ? side / sideLength : vec3(0);
  vec3 corner = p.positionWidth.xyz + side * (0.5 * ribbon) * ((gl_VertexID & 1) == 0 ? -1.0 : 1.0);
  gl_Position = vec4((shadowFromWorld * vec4(corner, 1)).xyz * 2.0 - 1.0, 1);
}
