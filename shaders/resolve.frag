// Mean of a pixel's samples. With a shoulder each is compressed first, so that one bright sample does not make a jagged edge.
layout(binding = 0) uniform sampler2DMS samples;
layout(location = 0) uniform int sampleCount;
layout(location = 1) uniform float shoulder;
layout(location = 0) out vec4 color;
void main() {
  vec4 sum = vec4(0);
  for (int s = 0; s < sampleCount; ++s) {
    vec4 c = texelFetch(samples, ivec2(gl_FragCoord.xy), s);
    float peak = max(c.r, max(c.g, c.b));
    sum += vec4(c.rgb / (1.0 + shoulder * peak), c.a);
  }
  color = sum / float(sampleCount);
}
