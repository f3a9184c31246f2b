#include "frame.glsl"
#include "random.glsl"
#include "sample_mask.glsl"
in vec3 shaded;
in float coverage;
flat in uint seed;
layout(location = 0) out vec4 color;

void main() {
  gl_SampleMask[0] = sampleMask(coverage, fragmentBits(seed, uint(viewport.z)));
  color = vec4(shaded, 1.0);
}
