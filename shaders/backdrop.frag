// A studio backdrop: a gradient with a soft light behind the model.
#include "frame.glsl"
in vec2 place;
layout(location = 0) out vec4 color;
void main() {
  vec2 d = (place - vec2(0.5, 0.55)) * vec2(viewport.x / viewport.y, 1.0);
  float glow = exp(-2.8 * dot(d, d));
  vec3 base = mix(backgroundBottom.rgb, backgroundTop.rgb, smoothstep(0.0, 1.0, 0.35 * place.y + 0.65 * glow));
  color = vec4(base, 1.0);
}
