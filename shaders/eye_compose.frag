// Hair over what is behind it; premultiplied.
layout(location = 0) uniform int width;
layout(location = 0) out vec4 color;

#ifdef COMPOSE_WEIGHTED
// The mean colour, as much of it as the product of all 1 − α does not let through: for occupancy-ordered weights this
// is Λ / a, Λ what the fragments cover together and a the sum of the weights (Sintorn & Assarsson 2009, corrected).
layout(binding = 0) uniform sampler2D sums;              // Σ w C, Σ w
layout(binding = 1) uniform sampler2D transmittances;    // Π (1 − α)
void main() {
  vec4 sum = texelFetch(sums, ivec2(gl_FragCoord.xy), 0);
  float covered = 1.0 - texelFetch(transmittances, ivec2(gl_FragCoord.xy), 0).x;
  color = sum.a > 0.0 ? vec4(sum.rgb / sum.a, 1) * covered : vec4(0);
}
#endif

#ifdef COMPOSE_SLICES          // they are composed already
layout(binding = 0) uniform sampler2D slices;
void main() { color = texelFetch(slices, ivec2(gl_FragCoord.xy), 0); }
#endif

#ifdef COMPOSE_LISTS
#include "lists.glsl"
void main() {
  int at = int(gl_FragCoord.y) * width + int(gl_FragCoord.x);
  float left = 1.0;
  vec3 sum = vec3(0);
  for (uint i = starts[at]; i < starts[at + 1] && left > 1e-5; ++i) {
    vec2 rg = unpackHalf2x16(entries[i].redGreen), ba = unpackHalf2x16(entries[i].blueAlpha);
    sum += left * ba.y * vec3(rg, ba.x);
    left *= 1.0 - ba.y;
  }
  color = vec4(sum, 1.0 - left);
}
#endif

#ifdef COMPOSE_LAYERS
#include "frame.glsl"
#include "eye_layers.glsl"
layout(location = 4) uniform vec2 depthRange;   // nearest, farthest
void main() {
  uint index = pixelIndex(ivec2(gl_FragCoord.xy));
  if (nearest[index] == 0xffffffffu) discard;
  float left = 1.0, depth = uintBitsToFloat(nearest[index]);
  vec3 sum = vec3(0);
  for (uint k = 0u; k < uint(kLayers); ++k) {
    Layer layer = layers[index * uint(kLayers) + k];
    vec4 all = vec4(layer.red, layer.green, layer.blue, layer.depth);
    all += 4294967296.0 * vec4((uvec4(layer.carried) >> uvec4(0u, 8u, 16u, 24u)) & 255u);
    if (!(all.w > 0.0)) continue;
    float after = left * exp(-all.w * kUnit);
    sum += (left - after) * all.rgb / all.w;
    left = after;
  }
  color = vec4(sum, 1.0 - left);
  // What is drawn over the picture later is in front of the hair, or hidden by it; thin hair hides nothing.
  if (left > 0.5) depth = headDepths[index].x;
  gl_FragDepth = clamp((depthRange.y - depthRange.x * depthRange.y / depth) / (depthRange.y - depthRange.x), 0.0, 1.0);
}
#endif
