// Mean of the sub-frames, soft shoulder, sRGB, straight alpha.
layout(binding = 0) uniform sampler2D sum;
layout(location = 0) uniform float inverseCount;
layout(location = 0) out vec4 color;
void main() {
  vec4 c = texelFetch(sum, ivec2(gl_FragCoord.xy), 0) * inverseCount;
  if (c.a > 0.0) c.rgb /= c.a;
  vec3 x = max(c.rgb, 0.0);
  vec3 low = x * 12.92, high = 1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055;
  color = vec4(clamp(mix(high, low, lessThanEqual(x, vec3(0.0031308))), 0.0, 1.0), clamp(c.a, 0.0, 1.0));
}
