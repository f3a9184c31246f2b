// The depths of all fragments taken together, and the deepest texel.
#define WHOLE_RANGE coherent
#include "hair_map.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 2) uniform sampler2D mapRange;
void main() {
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  if (texel.x >= int(mapInfo.x) || texel.y >= int(mapInfo.x)) return;
  vec2 range = texelFetch(mapRange, texel, 0).xy;
  if (range.x > kEmpty) return;
  atomicMin(wholeNear, orderedBits(range.x));
  atomicMax(wholeFar, orderedBits(-range.y));
  atomicMax(greatestExtent, floatBitsToUint(max(-range.y - range.x, 0.0)));
}
