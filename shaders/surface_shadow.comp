// What the hair leaves of the key light on the first surface behind it, once a texel of the light's map instead of a
// pixel of the picture, and smoothed: the few widened hairs of a map stand farther apart than the many that they
// stand for. SURFACE_LIGHT: the transmittance, of 2 × 2 texels of the map. SURFACE_BLUR: one way of the smoothing.
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0, r16f) writeonly uniform image2D result;

#ifdef SURFACE_LIGHT
#include "frame.glsl"
#include "hair_map_query.glsl"
layout(binding = 1) uniform sampler2D headDepthMap;   // as visibility.glsl has it
float valueAt(ivec2 texel) {
  float sum = 0.0;
  for (int k = 0; k < 4; ++k) {
    ivec2 t = min(2 * texel + ivec2(k & 1, k >> 1), ivec2(mapInfo.x) - 1);
    // In front of the surface by half a texel, so that roots just below it do not count.
    float z = texelFetch(headDepthMap, t, 0).r;
    sum += exp(-opticalDepthAt(t, z < 1.0 ? z * shadowInfo.y - 0.5 * mapInfo.z : 2.0 * shadowInfo.y));
  }
  return 0.25 * sum;
}
#endif

#ifdef SURFACE_BLUR
layout(binding = 0) uniform sampler2D source;
layout(location = 0) uniform ivec2 along;
layout(location = 1) uniform float deviation;         // in texels
float valueAt(ivec2 texel) {
  int reach = int(ceil(2.5 * deviation)), last = textureSize(source, 0).x - 1;
  float sum = 0.0, weights = 0.0;
  for (int k = -reach; k <= reach; ++k) {
    float w = exp(-0.5 * float(k * k) / (deviation * deviation));
    sum += w * texelFetch(source, clamp(texel + k * along, ivec2(0), ivec2(last)), 0).r;
    weights += w;
  }
  return sum / weights;
}
#endif

void main() {
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  if (all(lessThan(texel, imageSize(result)))) imageStore(result, texel, vec4(valueAt(texel)));
}
