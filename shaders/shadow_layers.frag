// Adds the hair's optical depth to its layer and to all behind it.
#include "frame.glsl"
layout(binding = 2) uniform sampler2D hairFrontMap;
in float coverage;
layout(location = 0) out vec4 depth;
void main() {
  float front = texelFetch(hairFrontMap, ivec2(gl_FragCoord.xy), 0).r;
  float d = (gl_FragCoord.z - front) * shadowInfo.y;
  float beta = -log(1.0 - min(coverage, 0.98));
  depth = beta * vec4(lessThan(vec4(d), vec4(shadowLayers.xyz, 3.4e38)));
}
