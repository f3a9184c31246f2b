// Mean of the sub-frames, soft shoulder, sRGB, straight alpha.
#include "random.glsl"
layout(binding = 0) uniform sampler2D sum;
layout(location = 0) uniform float inverseCount;
layout(location = 0) out vec4 color;
void main() {
  vec4 c = texelFetch(sum, ivec2(gl_FragCoord.xy), 0) * inverseCount;
  if (c.a > 0.0) c.rgb /= c.a;
  vec3 x = max(c.rgb, 0.0);
  vec3 low = x * 12.92, high = 1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055;
  // Half a step of noise, or the backdrop's gradient shows rings.
  float noise = random3(uint(gl_FragCoord.x), uint(gl_FragCoord.y), 99u) - 0.5;
  vec3 srgb = mix(high, low, lessThanEqual(x, vec3(0.0031308))) + (c.a > 0.0 ? noise / 255.0 : 0.0);
  color = vec4(clamp(srgb, 0.0, 1.0), clamp(c.a, 0.0, 1.0));
}
