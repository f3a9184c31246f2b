// Matte clay under three lights, darkened by the hair above it.
#include "frame.glsl"
#include "random.glsl"
#include "visibility.glsl"
in vec3 worldPosition;
in vec3 worldNormal;
layout(location = 0) out vec4 color;

void main() {
  vec3 v = normalize(eye.xyz - worldPosition);
  vec3 n = worldNormal / max(length(worldNormal), 1e-20);
  if (dot(n, v) < 0.0 && !gl_FrontFacing) n = -n;
  float u = 6.2831853 * random3(uint(gl_FragCoord.x), uint(gl_FragCoord.y), uint(viewport.z));
  vec4 hair = volumeAt(worldPosition + n * volumeLo.w);
  float key = 0.0;
  for (int k = 0; k < 4; ++k) {
    float a = u + 1.5707963 * float(k);
    vec2 offset = (1.0 + float(k)) * vec2(cos(a), sin(a));
    vec3 above = worldPosition + n * shadowInfo.w;
    key += 0.25 * keyPastHead(above, offset) * keyTransmittance(keyTaps(above, offset), vec3(1)).x;
  }
  vec3 transmitted = vec3(key, exp(-0.8 * hair.y), exp(-0.8 * hair.z));
  float up = 0.5 + 0.5 * dot(n, viewUp.xyz);
  vec3 albedo = headColor.rgb;
  vec3 sum = mix(groundColor.rgb, skyColor.rgb, up) * albedo * hair.w;
  for (int l = 0; l < 3; ++l) {
    vec3 toLight = lightDirection[l].xyz;
    float c = dot(n, toLight);
    // Wrapped by a quarter, redder in the wrap, as skin and wax are.
    vec3 wrapped = clamp((vec3(c) + vec3(0.28, 0.16, 0.12)) / (1.0 + vec3(0.28, 0.16, 0.12)), 0.0, 1.0);
    vec3 h = normalize(toLight + v);
    float nh = max(dot(n, h), 0.0), lh = max(dot(toLight, h), 0.0);
    float gloss = 0.045 * 5.0 * pow(nh, 24.0) * max(c, 0.0) / max(lh * lh, 0.1);
    sum += lightColor[l].rgb * transmitted[l] * (albedo * wrapped * wrapped * 0.32 + gloss * 0.32);
  }
  color = vec4(sum, 1.0);
}
