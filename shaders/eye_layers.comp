// LAYERS_HEAD: depths of the head at each pixel's samples. LAYERS_NEAREST: the first hair. LAYERS_ADD: the sums.
#define COMPUTE
#include "frame.glsl"
#include "strand_buffer.glsl"
#include "eye_layers.glsl"
layout(local_size_x = 64) in;

#ifdef LAYERS_HEAD
layout(binding = 0) uniform sampler2DMS head;
layout(location = 4) uniform vec2 depthRange;   // nearest, farthest
void main() {
  uint index = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationID.x;
  uint width = uint(viewport.x);
  if (index >= width * uint(endRow - firstRow)) return;
  ivec2 pixel = ivec2(index % width, int(index / width) + firstRow);
  for (int s = 0; s < 4; ++s) {
    float z = texelFetch(head, pixel, s).x;
    headDepths[index][s] = z < 1.0 ? depthRange.x * depthRange.y / (depthRange.y - z * (depthRange.y - depthRange.x)) : 3e38;
  }
}
#else
#include "strand_walk.glsl"
layout(std430, binding = 4) readonly buffer Shades { uvec2 shades[]; };
layout(location = 0) uniform uint pointCount;

// The part of a pixel's samples where a hair at this depth is not behind the head.
float inFront(uint index, float depth) { return dot(vec4(lessThan(vec4(depth), headDepths[index])), vec4(0.25)); }

#ifdef LAYERS_NEAREST
void put(ivec2 pixel, float area, float depth, float along) {
  uint index = pixelIndex(pixel);
  if (inFront(index, depth) > 0.0) atomicMin(nearest[index], floatBitsToUint(depth));  // positive: ordered as floats
}
#else
vec3 light, lightChange;
void add(uint sum, uint before, uint index, uint place) {
  if (before + sum < before) atomicAdd(layers[index].carried, 1u << place);
}
void put(ivec2 pixel, float area, float depth, float along) {
  uint index = pixelIndex(pixel);
  float seen = inFront(index, depth);
  if (!(seen > 0.0)) return;
  float amount = opticalDepthOf(area * seen);
  vec3 colored = amount * (light + along * lightChange);
  uvec4 sums = uvec4(vec4(colored, amount) / kUnit + 0.5);
  uint at = index * uint(kLayers) + uint(layerOf(depth - uintBitsToFloat(nearest[index])));
  add(sums.x, atomicAdd(layers[at].red, sums.x), at, 0u);
  add(sums.y, atomicAdd(layers[at].green, sums.y), at, 8u);
  add(sums.z, atomicAdd(layers[at].blue, sums.z), at, 16u);
  add(sums.w, atomicAdd(layers[at].depth, sums.w), at, 24u);
}
vec3 lightOf(uint point) { return vec3(unpackHalf2x16(shades[point].x), unpackHalf2x16(shades[point].y).x); }
#endif

void main() {
  uint point = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationID.x;
  if (point + 1u >= pointCount) return;
#ifdef LAYERS_ADD
  light = lightOf(point);
  lightChange = lightOf(point + 1u) - light;
#endif
  walkSegment(point, firstRow, endRow);
}
#endif
