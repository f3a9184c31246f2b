// Camera-facing ribbons, at least a pixel wide; light that reaches each point is found here, shading is per fragment.
#include "frame.glsl"
#include "random.glsl"
#include "strand_buffer.glsl"
#ifdef SHADOWS
#include "visibility.glsl"
#endif
out vec3 worldPosition;
out vec3 tangent;
out vec3 baseColor;
out vec3 reach[3];             // light that arrives from key, fill and rim, by colour
out vec3 sky;
out float coverage;            // width over the ribbon's width
flat out uint seed;

// A hair swallows less of the light that it lets through, so fair hair shades itself less.
vec3 throughHair(float depth, vec3 c) { return exp(-depth * shadowRight.w * (1.0 - 0.72 * pow(c, vec3(0.38)))); }

void main() {
  StrandPoint p = strandPoints[gl_VertexID >> 1];
  seed = floatBitsToUint(p.tangentSeed.w);
  worldPosition = p.positionWidth.xyz;
  tangent = p.tangentSeed.xyz;
  vec3 toEye = eye.xyz - worldPosition;
  float depth = max(-dot(toEye, viewForward.xyz), viewForward.w);
  float pixel = eye.w * depth;
  float width = p.positionWidth.w;
  float ribbon = max(width, pixel);
  coverage = width / ribbon;

  vec3 side = cross(tangent, toEye);
  float sideLength = length(side);
  side = sideLength > 1e-6 * length(toEye) ? side / sideLength : vec3(0);
  vec3 corner = worldPosition + side * (0.5 * ribbon) * ((gl_VertexID & 1) == 0 ? -1.0 : 1.0);
  gl_Position = clipFromWorld * vec4(corner, 1);

  // Each hair a little lighter or darker, warmer or cooler than the next.
  vec3 c = hairColor.w > 0.5 ? p.colorAlong.rgb : hairColor.rgb;
  float shade = random3(seed, 1u, 7u), warmth = random3(seed, 2u, 7u) - 0.5;
  c *= mix(0.72, 1.28, shade) * mix(0.85, 1.12, p.colorAlong.w);
  baseColor = clamp(c * (1.0 + warmth * vec3(0.16, 0.0, -0.16)), 0.0, 1.0);

#ifdef SHADOWS
  uint frame = uint(viewport.z);
  float a = 6.2831853 * random3(seed, uint(gl_VertexID >> 1), frame), r = 1.6 * sqrt(random3(seed, frame, 3u));
  vec2 key = keyVisibility(worldPosition, r * vec2(cos(a), sin(a)));
  vec4 volume = volumeAt(worldPosition);
  reach[0] = key.y * throughHair(key.x, baseColor);
  reach[1] = throughHair(volume.y, baseColor);
  reach[2] = throughHair(volume.z, baseColor);
  sky = vec3(volume.w);
#else
  reach[0] = reach[1] = reach[2] = sky = vec3(1);
#endif
}
