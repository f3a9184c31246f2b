#include "frame.glsl"
#include "random.glsl"
#include "sample_mask.glsl"
in vec3 shaded;
flat in uint seed;
in float coverage;
float alphaHere() { return clamp(coverage, 0.0, 0.99999994); }

#ifdef EYE_OPAQUE
layout(location = 0) out vec4 color;
void main() {
  if (!(alphaHere() > 0.0)) discard;
  color = vec4(shaded, 1);
}
#endif

#ifdef EYE_STOCHASTIC
layout(location = 0) out vec4 color;
void main() {
  float a = alphaHere();
  gl_SampleMask[0] = sampleMask(a < 0.9999 ? a : 1.0, fragmentBits(seed, uint(viewport.z)));
  color = vec4(shaded, 1);
}
#endif

#ifdef EYE_COVERAGE
layout(location = 0) out vec4 color;
// Dithered to all or nothing. Which samples a driver takes for an alpha between is its own affair, and it is the same ones
// for every hair, so that hairs would hide each other; of 0 and 1 there is no choice, and the mean is right.
void main() {
  float u = float(fragmentBits(seed, uint(viewport.z)) >> 8u) * (1.0 / 16777216.0);
  color = vec4(shaded, u < alphaHere() ? 1 : 0);
}
#endif

#ifdef EYE_SLICE
layout(location = 0) out vec4 color;
void main() { color = alphaHere() * vec4(shaded, 1); }
#endif

#ifdef EYE_WEIGHTED
layout(location = 0) out vec4 sum;
layout(location = 1) out vec4 lost;
void main() {
  float a = alphaHere();
  sum = a * vec4(shaded, 1);
  lost = vec4(a);
}
#endif

#ifdef EYE_OCCUPANCY
#include "hair_map_query.glsl"
in vec3 worldPosition;
layout(location = 0) out vec4 sum;
layout(location = 1) out vec4 lost;
// α e^−Ω, Ω what the map knows to be in front: (1 − α)^order where α is the same for all.
void main() {
  float a = alphaHere();
  sum = a * exp(-min(mapTaps(worldPosition, vec2(0), false).depths.x, 80.0)) * vec4(shaded, 1);
  lost = vec4(a);
}
#endif

#ifdef EYE_COUNT
layout(early_fragment_tests) in;
layout(binding = 1, r32ui) uniform uimage2D listCounts;
void main() {
  if (alphaHere() > 0.0) imageAtomicAdd(listCounts, ivec2(gl_FragCoord.xy), 1u);
}
#endif

#ifdef EYE_LIST
#define LIST_OF_EYE
#include "lists.glsl"
layout(early_fragment_tests) in;
layout(binding = 1, r32ui) uniform uimage2D listCounts;
void main() {
  float a = alphaHere();
  if (!(a > 0.0)) return;
  ivec2 here = ivec2(gl_FragCoord.xy);
  uint slot = starts[here.y * int(viewport.x) + here.x] + imageAtomicAdd(listCounts, here, 1u);
  entries[slot] = Entry(gl_FragCoord.z, packHalf2x16(shaded.rg), packHalf2x16(vec2(shaded.b, a)));
}
#endif
