// Sums of a walk over the map as the textures that look-ups read; layers and slices add up.
#include "hair_map.glsl"
#include "map_sums.glsl"
layout(local_size_x = 8, local_size_y = 8) in;

#ifdef RESOLVE_RANGE
layout(binding = 0, rg32f) writeonly uniform image2D range;
void resolve(ivec2 texel) {
  uint at = mapIndex(texel);
  bool none = nearestBits[at] == 0xffffffffu;
  float near = fromOrderedBits(nearestBits[at]), far = fromOrderedBits(farthestBits[at]);
  imageStore(range, texel, none ? vec4(3e38, 3e38, 0, 0) : vec4(near, -far, 0, 0));
}
#endif

#ifdef RESOLVE_LAYERS
layout(binding = 0, rgba32f) uniform image2DArray layers;
layout(location = 1) uniform ivec2 sliceRange;      // first, in fours, and one past the last
void resolve(ivec2 texel) {
  int count = sliceRange.y - sliceRange.x;
  float sum = sliceRange.x > 0 ? imageLoad(layers, ivec3(texel, sliceRange.x / 4 - 1)).w : 0.0;
  for (int k = 0; k < count; k += 4) {
    vec4 four;
    for (int c = 0; c < 4; ++c) {
      if (k + c < count) sum += float(sums[mapIndex(texel) * uint(count) + uint(k + c)]) * kSumUnit;
      four[c] = sum;
    }
    imageStore(layers, ivec3(texel, (sliceRange.x + k) / 4), four);
  }
}
#endif

#ifdef RESOLVE_OCCUPANCY
layout(binding = 0, rgba32f) writeonly uniform image2DArray slabs;
layout(binding = 2, r32ui) writeonly uniform uimage2DArray bits;
void resolve(ivec2 texel) {
  uint at = mapIndex(texel) * 8u;
  imageStore(slabs, ivec3(texel, 0), vec4(sums[at], sums[at + 1u], sums[at + 2u], sums[at + 3u]) * kSumUnit);
  for (int k = 0; k < 4; ++k) imageStore(bits, ivec3(texel, k), uvec4(sums[at + 4u + uint(k)]));
}
#endif

void main() {
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  if (texel.x < int(mapInfo.x) && texel.y < int(mapInfo.x)) resolve(texel);
}
