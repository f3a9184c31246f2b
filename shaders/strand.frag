// Shades a hair; its coverage becomes a random sample mask, so overlapping hairs need no sorting.
#include "frame.glsl"
#include "random.glsl"
#include "fibre.glsl"
in vec3 worldPosition;
in vec3 tangent;
in vec3 baseColor;
in vec3 reach[3];
in vec3 sky;
in float coverage;
flat in uint seed;
layout(location = 0) out vec4 color;

void main() {
  // floor(coverage n + u) of n samples, starting at a random one: right on average for any coverage.
  uint pixel = uint(gl_FragCoord.y) * 8192u + uint(gl_FragCoord.x);
  float u = random3(pixel, seed, uint(viewport.z));
  int samples = gl_NumSamples;
  int wanted = int(floor(clamp(coverage, 0.0, 1.0) * float(samples) + u));
  if (wanted <= 0) discard;
  if (wanted < samples) {
    uint first = hash3(uvec3(pixel, seed, uint(viewport.z) + 64u)) % uint(samples);
    int mask = 0;
    for (int k = 0; k < wanted; ++k) mask |= 1 << int((first + uint(k)) % uint(samples));
    gl_SampleMask[0] = mask;
  } else {
    gl_SampleMask[0] = -1;
  }

  vec3 t = tangent / max(length(tangent), 1e-20);
  vec3 v = normalize(eye.xyz - worldPosition);
  float shift = (random3(seed, 5u, 7u) - 0.5) * 0.10;
  float upness = 0.5 + 0.5 * sqrt(max(1.0 - pow(dot(t, viewUp.xyz), 2.0), 0.0));
  vec3 sum = mix(groundColor.rgb, skyColor.rgb, upness) * baseColor * sky * 0.8;
  for (int l = 0; l < 3; ++l) {
    sum += lightColor[l].rgb * reach[l] * scatter(t, lightDirection[l].xyz, v, baseColor, shift);
  }
  color = vec4(min(sum, vec3(8.0)), 1.0);
}
