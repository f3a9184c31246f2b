// Matte clay under three lights, darkened by the hair above it: diffuse, or with SHADING_STUDIO as skin and wax are.
#include "frame.glsl"
#include "surface_light.glsl"
in vec3 worldPosition;
in vec3 worldNormal;
layout(location = 0) out vec4 color;

void main() {
  vec3 v = normalize(eye.xyz - worldPosition);
  vec3 n = worldNormal / max(length(worldNormal), 1e-20);
  if (dot(n, v) < 0.0 && !gl_FrontFacing) n = -n;
  SurfaceLight light = lightOn(worldPosition, n);
  float up = 0.5 + 0.5 * dot(n, viewUp.xyz);
  vec3 albedo = headColor.rgb;
  vec3 sum = mix(groundColor.rgb, skyColor.rgb, up) * albedo * light.sky;
  for (int l = 0; l < 3; ++l) {
    vec3 toLight = lightDirection[l].xyz;
    float c = dot(n, toLight);
#ifdef SHADING_STUDIO
    // Wrapped by a quarter, redder in the wrap, as skin and wax are.
    vec3 wrapped = clamp((vec3(c) + vec3(0.28, 0.16, 0.12)) / (1.0 + vec3(0.28, 0.16, 0.12)), 0.0, 1.0);
    vec3 h = normalize(toLight + v);
    float nh = max(dot(n, h), 0.0), lh = max(dot(toLight, h), 0.0);
    float gloss = 0.045 * 5.0 * pow(nh, 24.0) * max(c, 0.0) / max(lh * lh, 0.1);
    sum += lightColor[l].rgb * light.transmitted[l] * (albedo * wrapped * wrapped * 0.32 + gloss * 0.32);
#else
    sum += lightColor[l].rgb * light.transmitted[l] * albedo * (max(c, 0.0) * 0.31830989);
#endif
  }
  color = vec4(sum, 1.0);
}
