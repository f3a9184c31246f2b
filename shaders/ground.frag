// A matte disc under the lights, with the shadows of head and hair.
#include "frame.glsl"
#include "surface_light.glsl"
in vec3 worldPosition;
layout(location = 0) uniform vec4 groundDisc;
layout(location = 1) uniform vec3 groundNormal;
layout(location = 2) uniform vec3 groundAlbedo;
layout(location = 0) out vec4 color;

void main() {
  if (distance(worldPosition, groundDisc.xyz) > groundDisc.w) discard;
  vec3 n = dot(eye.xyz - groundDisc.xyz, groundNormal) < 0.0 ? -groundNormal : groundNormal;
  SurfaceLight light = lightOn(worldPosition, n);
  vec3 sum = mix(groundColor.rgb, skyColor.rgb, 0.5 + 0.5 * dot(n, viewUp.xyz)) * light.sky;
  for (int l = 0; l < 3; ++l)
    sum += lightColor[l].rgb * light.transmitted[l] * (max(dot(n, lightDirection[l].xyz), 0.0) * 0.31830989);
  color = vec4(groundAlbedo * sum, 1);
}
