// Hair on the light's map without the graphics pipeline: one invocation a segment walks its texels by the rule of
// include/coif/light/fragments.h. Sums are whole numbers, so that they do not depend on the order of the hairs.
#define COMPUTE
#include "hair_map.glsl"
#include "strand_buffer.glsl"
#include "map_sums.glsl"
layout(local_size_x = 64) in;
layout(location = 0) uniform uint pointCount;


#ifdef WALK_RANGE
void put(ivec2 texel, float depth, float beta) {
  uint at = mapIndex(texel);
  atomicMin(nearestBits[at], orderedBits(depth));
  atomicMax(farthestBits[at], orderedBits(depth));
}
#endif

#if defined(WALK_DEEP) || defined(WALK_OPACITY) || defined(WALK_OCCUPANCY)
layout(binding = 2) uniform sampler2D mapRange;     // nearest depth, −farthest
// What would run over stays at the greatest sum: no light is left there.
void add(uint at, float beta) {
  uint amount = uint(beta / kSumUnit + 0.5);
  if (atomicAdd(sums[at], amount) > 0xffffffffu - amount) atomicMax(sums[at], 0xffffffffu);
}
#endif

#ifdef WALK_DEEP
void put(ivec2 texel, float depth, float beta) {
  float d = depth - texelFetch(mapRange, texel, 0).x;
  int k = 0, last = mapCounts.x - 1;
  while (k < last && d >= layerEnd(k)) ++k;
  if (k == last && d >= layerEnd(last) && mapCounts.z != kAddToLast) return;
  add(mapIndex(texel) * uint(mapCounts.x) + uint(k), beta);
}
#endif

#ifdef WALK_OPACITY
layout(location = 1) uniform ivec2 sliceRange;      // first and one past the last of this pass
void put(ivec2 texel, float depth, float beta) {
  float d = depth - fromOrderedBits(wholeNear);
  int k = clamp(int(d / wholeExtent() * float(mapCounts.x)), 0, mapCounts.x - 1);
  if (k < sliceRange.x || k >= sliceRange.y) return;
  add(mapIndex(texel) * uint(sliceRange.y - sliceRange.x) + uint(k - sliceRange.x), beta);
}
#endif

#ifdef WALK_OCCUPANCY
void put(ivec2 texel, float depth, float beta) {
  vec2 range = texelFetch(mapRange, texel, 0).xy;
  int slice = sliceOf(depth - range.x, -range.y - range.x, 128);
  uint at = mapIndex(texel) * 8u + uint(slice >> 5);
  add(at, beta);
  atomicOr(sums[at + 4u], 1u << (slice & 31));
}
#endif

#ifdef WALK_COUNT
layout(binding = 1, r32ui) uniform uimage2D listCounts;
void put(ivec2 texel, float depth, float beta) { imageAtomicAdd(listCounts, texel, 1u); }
#endif

#ifdef WALK_LIST
#include "lists.glsl"
layout(binding = 1, r32ui) uniform uimage2D listCounts;
void put(ivec2 texel, float depth, float beta) {
  entries[starts[mapIndex(texel)] + imageAtomicAdd(listCounts, texel, 1u)] = Entry(depth, beta);
}
#endif

void main() {
  uint point = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationID.x;
  if (point + 1u >= pointCount || strandPoints[point].seed != strandPoints[point + 1u].seed) return;
  vec4 p = strandPoints[point].positionWidth, q = strandPoints[point + 1u].positionWidth;
  vec4 a = mapProject(p.xyz), b = mapProject(q.xyz);
  float widthA = p.w, widthB = q.w;
  bool perspective = mapCounts.w == 1;
  if (perspective && min(a.z, b.z) < mapInfo.y) {   // cut where the light is nearer than it can see
    if (max(a.z, b.z) <= mapInfo.y) return;
    float cut = clamp((mapInfo.y - a.z) / (b.z - a.z), 0.0, 1.0);
    vec4 middle = mapProject(mix(p.xyz, q.xyz, cut));
    if (a.z < mapInfo.y) { a = middle; widthA = mix(p.w, q.w, cut); } else { b = middle; widthB = mix(p.w, q.w, cut); }
  }
  vec2 d = b.xy - a.xy;
  bool alongX = abs(d.x) >= abs(d.y);
  vec2 from = alongX ? a.xy : a.yx;
  d = alongX ? d : d.yx;
  if (!(abs(d.x) > 0.0)) return;                    // a point on the map has no step to stand on
  float slope = d.y / d.x, stretch = sqrt(1.0 + slope * slope);
  int first = int(ceil(max(min(from.x, from.x + d.x), 0.0) - 0.5));
  int end = int(ceil(min(max(from.x, from.x + d.x), mapInfo.x) - 0.5));
  for (int i = first; i < end; ++i) {
    float step = float(i) + 0.5 - from.x, across = from.y + step * slope;
    if (!(across >= 0.0 && across < mapInfo.x)) continue;
    float u = clamp(step / d.x, 0.0, 1.0);
    float t = perspective ? u * a.z / (b.z * (1.0 - u) + u * a.z) : u;
    float depth = mix(a.z, b.z, t);
    float alpha = min(mapInfo.w * mix(widthA, widthB, t) * stretch / texelAt(depth), 0.99999994);
    if (alpha > 0.0) put(alongX ? ivec2(i, int(across)) : ivec2(int(across), i), depth, opticalDepthOf(alpha));
  }
}
