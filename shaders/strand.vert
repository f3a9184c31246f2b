// Camera-facing ribbons, at least a pixel wide. Points are close on the screen, so shading is per point: a fragment
// of a hair is cheap, and there are very many.
#include "frame.glsl"
#include "random.glsl"
#include "strand_buffer.glsl"
#ifdef SHADOWS
#include "visibility.glsl"
#endif
#include "fibre.glsl"
out vec3 shaded;
out float coverage;            // width over the ribbon's width
flat out uint seed;

// A hair swallows less of the light that it lets through, so fair hair shades itself less.
vec3 extinction(vec3 c) { return 1.0 - 0.72 * pow(c, vec3(0.38)); }

void main() {
  StrandPoint p = strandPointAt(strandVertex());
  seed = floatBitsToUint(p.tangentSeed.w);
  vec3 worldPosition = p.positionWidth.xyz, tangent = p.tangentSeed.xyz;
  vec3 toEye = eye.xyz - worldPosition;
  float depth = max(-dot(toEye, viewForward.xyz), viewForward.w);
  float pixel = eye.w * depth;
  float width = p.positionWidth.w;
  float ribbon = max(width, pixel);
  coverage = width / ribbon;

  vec3 side = cross(tangent, toEye);
  float sideLength = length(side);
  side = sideLength > 1e-6 * length(toEye) ? side / sideLength : vec3(0);
  vec3 corner = worldPosition + side * (ribbon * strandSide());
  gl_Position = clipFromWorld * vec4(corner, 1);

  // Each hair a little lighter or darker, warmer or cooler than the next.
  vec3 c = hairColor.w > 0.5 ? p.colorAlong.rgb : hairColor.rgb;
  float shade = random3(seed, 1u, 7u), warmth = random3(seed, 2u, 7u) - 0.5;
  c *= mix(0.72, 1.28, shade) * mix(0.85, 1.12, p.colorAlong.w);
  vec3 baseColor = clamp(c * (1.0 + warmth * vec3(0.16, 0.0, -0.16)), 0.0, 1.0);

  vec3 reach[3] = vec3[3](vec3(1), vec3(1), vec3(1));  // of the light of key, fill and rim
  float sky = 1.0;
#ifdef SHADOWS
  uint frame = uint(viewport.z);
  float a = 6.2831853 * random3(seed, uint(strandVertex()), frame), r = 1.6 * sqrt(random3(seed, frame, 3u));
  vec2 offset = r * vec2(cos(a), sin(a));
  vec4 volume = volumeAt(worldPosition);
  vec3 strength = extinction(baseColor);
  reach[0] = keyPastHead(worldPosition, offset) * keyTransmittance(keyTaps(worldPosition, offset), strength);
  reach[1] = exp(-0.75 * volume.y * strength);
  reach[2] = exp(-0.75 * volume.z * strength);
  sky = volume.w;
#endif

  vec3 v = toEye / max(length(toEye), 1e-20);
  float shift = (random3(seed, 5u, 7u) - 0.5) * 0.10;
  float upness = 0.5 + 0.5 * sqrt(max(1.0 - pow(dot(tangent, viewUp.xyz), 2.0), 0.0));
  shaded = mix(groundColor.rgb, skyColor.rgb, upness) * baseColor * (0.8 * sky);
  for (int l = 0; l < 3; ++l) {
    shaded += lightColor[l].rgb * reach[l] * scatter(tangent, lightDirection[l].xyz, v, baseColor, shift);
  }
  shaded = min(shaded, vec3(8.0));
}
