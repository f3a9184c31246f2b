// Hairs for the eye: camera-facing ribbons, at least a pixel wide, or lines of a pixel. Their light is in `shades`
// (strand_shade.comp).
#include "frame.glsl"
#if defined(EYE_OPAQUE) || defined(EYE_STOCHASTIC) || defined(EYE_COVERAGE)
#define SAMPLES
#endif
#include "strand_buffer.glsl"
layout(std430, binding = 4) readonly buffer Shades { uvec2 shades[]; };
out vec3 shaded;
flat out uint seed;
#ifdef EYE_OCCUPANCY
out vec3 worldPosition;
#endif
out float coverage;            // width over the ribbon's width

void main() {
  int point = strandVertex();
  StrandPoint p = strandPointAt(point);
  seed = floatBitsToUint(p.tangentSeed.w);
  uvec2 light = shades[shadeOfVertex()];
  shaded = vec3(unpackHalf2x16(light.x), unpackHalf2x16(light.y).x);
  vec3 toEye = eye.xyz - p.positionWidth.xyz, corner = p.positionWidth.xyz;
  float pixel = eye.w * max(-dot(toEye, viewForward.xyz), viewForward.w);
  float ribbon = max(p.positionWidth.w, pixel);
  coverage = p.positionWidth.w / ribbon;
  vec3 side = cross(p.tangentSeed.xyz, toEye);
  float sideLength = length(side);
  side = sideLength > 1e-6 * length(toEye) ? side / sideLength : vec3(0);
  corner += side * (ribbon * strandSide());
#if defined(LINES) && !defined(SAMPLES)
  // Without samples a line takes one pixel a row or column: a slanted one is thinner across itself.
  vec3 right = cross(viewForward.xyz, viewUp.xyz);
  vec2 run = abs(vec2(dot(p.tangentSeed.xyz, right), dot(p.tangentSeed.xyz, viewUp.xyz)));
  coverage *= length(run) > 1e-6 ? length(run) / max(run.x, run.y) : 1.0;
#endif
#ifdef EYE_OCCUPANCY
  worldPosition = corner;
#endif
  gl_Position = clipFromWorld * vec4(corner, 1);
}
