// Ribbons that face the key light, at least a texel wide.
#include "frame.glsl"
#include "strand_buffer.glsl"
out float coverage;
void main() {
  StrandPoint p = strandPointAt(strandVertex());
  float ribbon = max(p.positionWidth.w, shadowInfo.z);
  coverage = p.positionWidth.w / ribbon;
#ifdef LINES
  // Without samples a line takes one texel a row or column: a slanted one is thinner across itself.
  vec2 run = abs(vec2(dot(p.tangentSeed.xyz, shadowRight.xyz), dot(p.tangentSeed.xyz, shadowUp.xyz)));
  coverage *= length(run) > 1e-6 ? length(run) / max(run.x, run.y) : 1.0;
#endif
  vec3 side = cross(p.tangentSeed.xyz, lightDirection[0].xyz);
  float sideLength = length(side);
  side = sideLength > 1e-6 ? side / sideLength : vec3(0);
  vec3 corner = p.positionWidth.xyz + side * (ribbon * strandSide());
  gl_Position = vec4((shadowFromWorld * vec4(corner, 1)).xyz * 2.0 - 1.0, 1);
}
