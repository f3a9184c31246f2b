// The light that each strand point sends to the eye. Points are close on the screen, so that shading is worked out
// once a point and picture, not a fragment: there are very many of those.
#define COMPUTE
#include "frame.glsl"
#include "random.glsl"
#include "strand_buffer.glsl"
#ifdef SHADOWS
#define WITH_HEAD
#include "visibility.glsl"
#endif
#ifdef SHADING_STUDIO
#include "fibre.glsl"
#else
#include "fibre_tables.glsl"
#endif
layout(local_size_x = 64) in;
layout(std430, binding = 4) writeonly buffer Shades { uvec2 shades[]; };   // RGB as halves
layout(location = 0) uniform uint pointCount;
layout(location = 1) uniform int lookUps;     // jittered, of the key light's map

// What stands between a point and the three lights.
struct Reach {
  vec4 keyDepths[4], keyWeights[4];   // by look-up
  vec3 pastHead;                      // key, fill, rim
  vec2 depths;                        // of hair, fill and rim
  float sky, ground;                  // open part of the upper and of the lower half of the sphere around
  float skyPastHair;                  // of the upper one, were there no head
};
Reach reachOf(vec3 p, uint seed, uint point) {
  Reach reach;
  reach.pastHead = vec3(1);
  reach.depths = vec2(0);
  reach.sky = 1.0;
  reach.ground = 1.0;
  reach.skyPastHair = 1.0;
  for (int k = 0; k < 4; ++k) reach.keyDepths[k] = vec4(0), reach.keyWeights[k] = vec4(0);
  reach.keyWeights[0].x = 1.0;
#ifdef SHADOWS
  float a = 6.2831853 * random3(seed, point, 0u), r = 1.6 * sqrt(random3(seed, point, 3u)), lit = 0.0;
  for (int k = 0; k < lookUps; ++k) {
    float turn = a + 6.2831853 * float(k) / float(lookUps);
    vec2 offset = r * vec2(cos(turn), sin(turn));
    Taps taps = keyTaps(p, offset);
    reach.keyDepths[k] = taps.depths;
    reach.keyWeights[k] = taps.weights / float(lookUps);
    lit += keyPastHead(p, offset, shadowInfo.w) / float(lookUps);
  }
  vec4 all = volumeAt(p), hair = volumeIn(hairVolume, p);
  reach.pastHead = vec3(lit, exp(-max(all.yz - hair.yz, 0.0)));
  // The volume's fog reaches about two cells beyond the hair it stands for: half a cell by filling cells, one by
  // interpolating, the rest by sweeping. Hair at the surface would lie in its own shadow (docs/preview.md).
  float step = 2.0 * volumeLo.w;
  reach.depths = vec2(volumeIn(hairVolume, p + step * lightDirection[1].xyz).y,
                      volumeIn(hairVolume, p + step * lightDirection[2].xyz).z);
  reach.sky = all.w;
  reach.skyPastHair = hair.w;
  reach.ground = all.x;
#endif
  return reach;
}

float upness(vec3 t) { return 0.5 + 0.5 * sqrt(max(1.0 - pow(dot(t, viewUp.xyz), 2.0), 0.0)); }

#ifdef SHADING_STUDIO
vec3 shade(StrandPoint p, uint seed, vec3 toEye, Reach reach) {
  vec3 t = p.tangentSeed.xyz;
  // Each hair a little lighter or darker, warmer or cooler than the next.
  vec3 c = hairColor.w > 0.5 ? p.colorAlong.rgb : hairColor.rgb;
  float lightness = random3(seed, 1u, 7u), warmth = random3(seed, 2u, 7u) - 0.5;
  c *= mix(0.72, 1.28, lightness) * mix(0.85, 1.12, p.colorAlong.w);
  vec3 base = clamp(c * (1.0 + warmth * vec3(0.16, 0.0, -0.16)), 0.0, 1.0);
  // A hair swallows less of the light that it lets through, so fair hair shades itself less.
  vec3 strength = 1.0 - 0.72 * pow(base, vec3(0.38)), reached[3];
  reached[0] = vec3(0);
  for (int k = 0; k < 4; ++k) {
    for (int c = 0; c < 4; ++c) reached[0] += reach.keyWeights[k][c] * exp(-reach.keyDepths[k][c] * strength);
  }
  reached[1] = exp(-0.75 * reach.depths.x * strength);
  reached[2] = exp(-0.75 * reach.depths.y * strength);
  float shift = (random3(seed, 5u, 7u) - 0.5) * 0.10;
  vec3 sum = mix(groundColor.rgb, skyColor.rgb, upness(t)) * base * (0.8 * reach.sky);
  for (int l = 0; l < 3; ++l) {
    sum += lightColor[l].rgb * reach.pastHead[l] * reached[l] *
           scatter(t, lightDirection[l].xyz, toEye, base, shift);
  }
  return sum;
}
#else
vec3 shade(StrandPoint p, uint seed, vec3 toEye, Reach reach) {
  vec3 t = p.tangentSeed.xyz;
  Bearings key = bearingsOf(t, lightDirection[0].xyz, toEye);
  vec3 sum = vec3(0);
  for (int k = 0; k < lookUps && lightColor[0].rgb != vec3(0); ++k) sum += reachedThrough(key, reach.keyDepths[k], reach.keyWeights[k]);
  sum *= lightColor[0].rgb * reach.pastHead.x;
  for (int l = 1; l < 3; ++l) {
    if (lightColor[l].rgb == vec3(0)) continue;
    Bearings b = bearingsOf(t, lightDirection[l].xyz, toEye);
    sum += lightColor[l].rgb * reach.pastHead[l] *
           reachedThrough(b, vec4(reach.depths[l - 1], 0, 0, 0), vec4(1, 0, 0, 0));
  }
  // Half of the sphere around lights the eye's side of a hair. Where hair hides no part of it, both halves are open.
  vec3 around = skyColor.rgb * reach.sky * skyThroughHair(reach.skyPastHair) + groundColor.rgb * reach.ground;
  return sum + around / max(reach.sky + reach.ground, 1.0) * evenAlbedo(key.thetaO);
}
#endif

#ifdef SLICED
layout(location = 2) uniform uint firstEntry;  // of the slice, whose segments' ends are lit: two a segment
#endif

void main() {
  uint point = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationID.x;
  if (point >= pointCount) return;
  uint place = point;
#ifdef SLICED
  uint end = point & 1u, segment = slicedSegments[firstEntry + (point >> 1u)];
  point = segment + end;
  place = 2u * segment + end;
#endif
  StrandPoint p = strandPointAt(int(point));
  uint seed = floatBitsToUint(p.tangentSeed.w);
  vec3 toEye = eye.xyz - p.positionWidth.xyz;
  toEye /= max(length(toEye), 1e-20);
  vec3 sum = clamp(shade(p, seed, toEye, reachOf(p.positionWidth.xyz, seed, point)), vec3(0), vec3(8));
  shades[place] = uvec2(packHalf2x16(sum.rg), packHalf2x16(vec2(sum.b, 0)));
}
