#include "frame.glsl"
#include "random.glsl"
in vec4 tint;
layout(location = 0) out vec4 color;
void main() {
  uint pixel = uint(gl_FragCoord.y) * 8192u + uint(gl_FragCoord.x);
  float u = random3(pixel, uint(gl_PrimitiveID), uint(viewport.z) + 128u);
  int samples = gl_NumSamples;
  int wanted = int(floor(tint.a * float(samples) + u));
  if (wanted <= 0) discard;
  uint first = hash3(uvec3(pixel, uint(gl_PrimitiveID), uint(viewport.z))) % uint(samples);
  int mask = 0;
  for (int k = 0; k < min(wanted, samples); ++k) mask |= 1 << int((first + uint(k)) % uint(samples));
  gl_SampleMask[0] = mask;
  color = vec4(tint.rgb, 1.0);
}
