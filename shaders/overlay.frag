#include "frame.glsl"
#include "random.glsl"
#include "sample_mask.glsl"
in vec4 tint;
layout(location = 0) out vec4 color;

void main() {
  gl_SampleMask[0] = sampleMask(tint.a, fragmentBits(uint(gl_PrimitiveID), uint(viewport.z) + 128u));
  color = vec4(tint.rgb, 1.0);
}
