// What walks over the map leave: whole numbers, which map_resolve.comp turns into the textures that look-ups read.
const float kSumUnit = 1.0 / 1048576.0;             // of optical depth: 32 bits hold 4096, of which no light is left
#if defined(WALK_RANGE) || defined(RESOLVE_RANGE)
layout(std430, binding = 1) buffer Nearest { uint nearestBits[]; };     // ordered bits of depths
layout(std430, binding = 2) buffer Farthest { uint farthestBits[]; };
#elif !defined(WALK_COUNT) && !defined(WALK_LIST)
layout(std430, binding = 1) buffer Sums { uint sums[]; };               // texel by texel
#endif
uint mapIndex(ivec2 texel) { return uint(texel.y) * uint(mapInfo.x) + uint(texel.x); }
