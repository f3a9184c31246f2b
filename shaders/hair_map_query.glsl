// Optical depth Ω of the hair between the key light and a point, by the method that the map was made with.
#include "hair_map.glsl"
layout(binding = 2) uniform sampler2D mapRange;          // nearest depth, −farthest
layout(binding = 3) uniform sampler2DArray mapLayers;    // four layers, slices or slabs a texel; clusters: see below
layout(binding = 4) uniform usampler2DArray mapOccupancy;

#ifdef VISIBILITY_NONE
float opticalDepthAt(ivec2 texel, float z) { return 0.0; }
#endif

#ifdef VISIBILITY_RUNNING      // half-angle slices: what the light has passed so far
float opticalDepthAt(ivec2 texel, float z) { return texelFetch(mapLayers, ivec3(texel, 0), 0).x; }
#endif

#ifdef VISIBILITY_OPACITY
float slice(ivec2 texel, int k) { return texelFetch(mapLayers, ivec3(texel, k >> 2), 0)[k & 3]; }
float opticalDepthAt(ivec2 texel, float z) {
  float d = z - fromOrderedBits(wholeNear), step = wholeExtent() / float(mapCounts.x);
  if (!(d > 0.0)) return 0.0;
  int k = min(int(d / step), mapCounts.x - 1);
  float before = k > 0 ? slice(texel, k - 1) : 0.0;
  return mix(before, slice(texel, k), min(d / step - float(k), 1.0));
}
#endif

#ifdef VISIBILITY_DEEP_OPACITY
float layer(ivec2 texel, int k) { return texelFetch(mapLayers, ivec3(texel, k >> 2), 0)[k & 3]; }
float opticalDepthAt(ivec2 texel, float z) {
  float d = z - texelFetch(mapRange, texel, 0).x;
  if (!(d > 0.0)) return 0.0;      // in front of the first hair, or no hair
  int k = 0;
  float from = 0.0, end = layerEnd(0);
  while (k < mapCounts.x - 1 && d >= end) from = end, end = layerEnd(++k);
  float before = k > 0 ? layer(texel, k - 1) : 0.0;
  return mix(before, layer(texel, k), min((d - from) / (end - from), 1.0));
}
#endif

#ifdef VISIBILITY_DENSITY_CLUSTERING
// Layers of the map: where a cluster's amount begins to rise, where it is all there, and how much it is.
float opticalDepthAt(ivec2 texel, float z) {
  vec4 from = texelFetch(mapLayers, ivec3(texel, 0), 0), to = texelFetch(mapLayers, ivec3(texel, 1), 0);
  vec4 amounts = texelFetch(mapLayers, ivec3(texel, 2), 0);
  float sum = 0.0;
  for (int k = 0; k < 4; ++k) {
    if (z > from[k]) sum += amounts[k] * (to[k] > from[k] ? min((z - from[k]) / (to[k] - from[k]), 1.0) : 1.0);
  }
  return sum;
}
#endif

#ifdef VISIBILITY_OCCUPANCY
float opticalDepthAt(ivec2 texel, float z) {
  vec2 range = texelFetch(mapRange, texel, 0).xy;
  if (!(z > range.x)) return 0.0;
  vec4 slabs = texelFetch(mapLayers, ivec3(texel, 0), 0);
  float extent = -range.y - range.x, d = extent > 0.0 ? (z - range.x) / extent : 2.0;
  if (d > 1.0) return dot(slabs, vec4(1));
  float place = min(d * 128.0, 127.0);
  int slice = int(place), slab = slice >> 5;
  uint bits = texelFetch(mapOccupancy, ivec3(texel, slab), 0).x, own = 1u << (slice & 31);
  float sum = dot(slabs, vec4(lessThan(ivec4(0, 1, 2, 3), ivec4(slab))));
  int total = bitCount(bits);
  if (total == 0) return sum;
  float before = float(bitCount(bits & (own - 1u))) + ((bits & own) != 0u ? d * 128.0 - float(slice) : 0.0);
  return sum + slabs[slab] * before / float(total);
}
#endif

#ifdef VISIBILITY_EXACT
layout(std430, binding = 1) readonly buffer MapFragments { vec2 mapFragments[]; };   // depth, Ω behind it
layout(std430, binding = 2) readonly buffer MapStarts { uint mapStarts[]; };
float opticalDepthAt(ivec2 texel, float z) {
  int at = texel.y * int(mapInfo.x) + texel.x;
  uint lo = mapStarts[at], hi = mapStarts[at + 1], begin = lo;
  while (lo < hi) {                // the first fragment that is not nearer
    uint middle = (lo + hi) / 2u;
    if (mapFragments[middle].x < z) lo = middle + 1u; else hi = middle;
  }
  return lo > begin ? mapFragments[lo - 1u].y : 0.0;
}
#endif

// What a look-up mixes: T is Σ weight · exp(−Ω), filtered after the exponential and never across depths.
struct Taps { vec4 depths, weights; };
Taps mapTaps(vec3 world, vec2 offsetTexels, bool bilinear) {
  vec4 p = mapProject(world);
  Taps taps = Taps(vec4(0), vec4(1, 0, 0, 0));
  if (!(p.w > 0.0)) return taps;
  p.xy += offsetTexels;
  if (!bilinear) {
    if (all(greaterThanEqual(p.xy, vec2(0))) && all(lessThan(p.xy, vec2(mapInfo.x))))
      taps.depths.x = opticalDepthAt(ivec2(p.xy), p.z);
    return taps;
  }
  vec2 corner = floor(p.xy - 0.5), f = p.xy - 0.5 - corner;
  for (int c = 0; c < 4; ++c) {
    vec2 o = vec2(c & 1, c >> 1), texel = corner + o;
    vec2 w = mix(1.0 - f, f, o);
    taps.weights[c] = w.x * w.y;
    if (all(greaterThanEqual(texel, vec2(0))) && all(lessThan(texel, vec2(mapInfo.x))))
      taps.depths[c] = opticalDepthAt(ivec2(texel), p.z);
  }
  return taps;
}
