// How much light reaches a point through the hair.
layout(binding = 0) uniform sampler3D lightVolume;     // optical depth to key, fill, rim; open sky in w
layout(binding = 1) uniform sampler2D headDepthMap;    // first head surface from the key light
layout(binding = 2) uniform sampler2D hairFrontMap;    // first hair from the key light
layout(binding = 3) uniform sampler2D hairLayerMap;    // optical depth to the far end of each layer

vec4 volumeAt(vec3 p) {
  vec3 c = (p - volumeLo.xyz) * volumeScale.xyz;
  vec4 inside = texture(lightVolume, c);
  vec3 outside = max(max(-c, c - 1.0), 0.0);
  float away = clamp(8.0 * max(outside.x, max(outside.y, outside.z)), 0.0, 1.0);
  return mix(inside, vec4(0, 0, 0, 1), away);
}

// Optical depth of the hair between the key light and p at one texel (deep opacity maps, Yuksel & Keyser 2008).
float layeredDepth(ivec2 texel, float z) {
  float front = texelFetch(hairFrontMap, texel, 0).r;
  if (front >= 1.0) return 0.0;
  float d = (z - front) * shadowInfo.y;
  if (d <= 0.0) return 0.0;
  vec4 g = texelFetch(hairLayerMap, texel, 0);
  vec4 ends = shadowLayers;
  if (d < ends.x) return g.x * d / ends.x;
  if (d < ends.y) return mix(g.x, g.y, (d - ends.x) / (ends.y - ends.x));
  if (d < ends.z) return mix(g.y, g.z, (d - ends.y) / (ends.z - ends.y));
  return mix(g.z, g.w, min((d - ends.z) / (ends.w - ends.z), 1.0));
}

// x: optical depth of hair, y: 1 lit, 0 behind the head; one jittered bilinear look-up.
vec2 keyVisibility(vec3 p, vec2 offsetTexels) {
  vec3 s = (shadowFromWorld * vec4(p, 1)).xyz;
  vec2 t = s.xy * shadowInfo.x - 0.5 + offsetTexels;
  if (any(lessThan(t, vec2(0))) || any(greaterThan(t, vec2(shadowInfo.x - 2.0)))) return vec2(0, 1);
  ivec2 base = ivec2(floor(t));
  vec2 f = t - vec2(base);
  float bias = shadowInfo.w / shadowInfo.y;
  vec2 sum = vec2(0);
  for (int k = 0; k < 4; ++k) {
    ivec2 o = ivec2(k & 1, k >> 1);
    float w = (o.x == 1 ? f.x : 1.0 - f.x) * (o.y == 1 ? f.y : 1.0 - f.y);
    float lit = texelFetch(headDepthMap, base + o, 0).r + bias >= s.z ? 1.0 : 0.0;
    sum += w * vec2(layeredDepth(base + o, s.z), lit);
  }
  return sum;
}
