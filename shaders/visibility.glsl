// How much light reaches a point through the hair.
#include "hair_map_query.glsl"
// Optical depth to key, fill and rim; open part of the sky in w. WITH_HEAD: the head stops light too, and x is the open
// part of the ground.
layout(binding = 0) uniform sampler3D lightVolume;
#ifdef WITH_HEAD
layout(binding = 7) uniform sampler3D hairVolume;      // without the head
#else
#define hairVolume lightVolume
#endif
layout(binding = 1) uniform sampler2D headDepthMap;    // first head surface from the key light

vec4 volumeIn(sampler3D volume, vec3 p) {
  vec3 c = (p - volumeLo.xyz) * volumeScale.xyz;
  vec4 inside = texture(volume, c);
  vec3 outside = max(max(-c, c - 1.0), 0.0);
  float away = clamp(8.0 * max(outside.x, max(outside.y, outside.z)), 0.0, 1.0);
  return mix(inside, vec4(0, 0, 0, 1), away);
}

vec4 volumeAt(vec3 p) { return volumeIn(lightVolume, p); }

// Hair between the key light and p, at a place moved by texels. Half a texel towards the light, so that a hair that
// leans towards it does not shadow itself.
Taps keyTaps(vec3 p, vec2 offsetTexels) {
#ifdef LIGHT_MAP
  return Taps(vec4(volumeIn(hairVolume, p).x, 0, 0, 0), vec4(1, 0, 0, 0));
#else
  return mapTaps(p + lightDirection[0].xyz * (0.5 * mapInfo.z), offsetTexels, shadowInfo.x > 0.5);
#endif
}

// 1 lit, 0 behind the head by more than `bias`.
float keyPastHead(vec3 p, vec2 offsetTexels, float bias) {
  vec4 s = mapProject(p);
  vec2 t = s.xy - 0.5 + offsetTexels;
  if (!(s.w > 0.0) || any(lessThan(t, vec2(0))) || any(greaterThan(t, vec2(mapInfo.x - 2.0)))) return 1.0;
  ivec2 base = ivec2(floor(t));
  vec2 f = t - vec2(base);
  float sum = 0.0;
  for (int k = 0; k < 4; ++k) {
    ivec2 o = ivec2(k & 1, k >> 1);
    float w = (o.x == 1 ? f.x : 1.0 - f.x) * (o.y == 1 ? f.y : 1.0 - f.y);
    float first = texelFetch(headDepthMap, base + o, 0).r;   // 1: no head, however far p lies behind the scene
    sum += w * (first == 1.0 || first * shadowInfo.y + bias >= s.z ? 1.0 : 0.0);
  }
  return sum;
}

// The same without noise, for surfaces: 4 × 4 texels weighted by a cubic spline.
float keyPastHeadSmoothly(vec3 p) {
  vec4 s = mapProject(p);
  vec2 t = s.xy - 0.5;
  if (!(s.w > 0.0) || any(lessThan(t, vec2(1))) || any(greaterThan(t, vec2(mapInfo.x - 3.0)))) return 1.0;
  ivec2 base = ivec2(floor(t)) - 1;
  vec2 f = fract(t), g = 1.0 - f;
  vec2 w[4] = vec2[](g * g * g / 6.0, (3.0 * f * f * f - 6.0 * f * f + 4.0) / 6.0,
                     (3.0 * g * g * g - 6.0 * g * g + 4.0) / 6.0, f * f * f / 6.0);
  float hidden = 0.0;
  for (int k = 0; k < 16; ++k) {
    float first = texelFetch(headDepthMap, base + ivec2(k & 3, k >> 2), 0).r;
    hidden += first == 1.0 || first * shadowInfo.y >= s.z ? 0.0 : w[k & 3].x * w[k >> 2].y;
  }
  return 1.0 - hidden;
}

// The part of the key light that is left, for extinction `strength` a channel of what hair has.
vec3 keyTransmittance(Taps taps, vec3 strength) {
  vec3 sum = vec3(0);
  for (int k = 0; k < 4; ++k) sum += taps.weights[k] * exp(-taps.depths[k] * strength);
  return sum;
}
