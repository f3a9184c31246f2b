// What interpolation within layers can be wrong by in T, as VisibilityMap::aPosterioriBound: the light that each layer
// takes, weighted by itself. A work group writes its own sums; adding them up is left to the host, in order.
#include "hair_map.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 3) uniform sampler2DArray mapLayers;
layout(std430, binding = 6) writeonly buffer Bounds { vec4 bounds[]; };   // Σ taken², Σ taken, greatest taken
shared vec3 part[64];

void main() {
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  vec3 own = vec3(0);
  if (texel.x < int(mapInfo.x) && texel.y < int(mapInfo.x)) {
    float before = 1.0;
    for (int k = 0; k < mapCounts.x; ++k) {
      float behind = exp(-texelFetch(mapLayers, ivec3(texel, k >> 2), 0)[k & 3]), taken = before - behind;
      own += vec3(taken * taken, taken, 0);
      own.z = max(own.z, taken);
      before = behind;
    }
  }
  uint at = gl_LocalInvocationIndex;
  part[at] = own;
  for (uint rest = 32u; rest > 0u; rest >>= 1u) {
    barrier();
    if (at < rest) {
      vec3 other = part[at + rest];
      part[at] = vec3(part[at].xy + other.xy, max(part[at].z, other.z));
    }
  }
  if (at == 0u) bounds[gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x] = vec4(part[0], 0);
}
