// Draws strands without the graphics pipeline: one invocation a segment walks its pixels and adds optical depth with
// 32-bit atomics, so that hairs may come in any order: 1 − exp(−Σ) is the coverage. A column of pixels (a row, for a
// steep segment) gets the area that the ribbon has in it, shared by the two pixels next to its middle: the areas add
// up to length × width. With NEAREST the nearest depth as well.
#define COMPUTE
#include "frame.glsl"
#include "strand_buffer.glsl"
layout(local_size_x = 64) in;
layout(std430, binding = 1) buffer Depths { uint opticalDepth[]; };  // in units of kUnit
layout(std430, binding = 2) buffer Nearest { uint nearest[]; };
layout(location = 0) uniform uint pointCount;
const float kUnit = 1.0 / 16384.0;

void put(ivec2 pixel, float area, float depth) {
  if (any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, ivec2(viewport.xy))) || !(area > 0.0)) return;
  uint index = uint(pixel.y) * uint(viewport.x) + uint(pixel.x);
  atomicAdd(opticalDepth[index], uint(-log(1.0 - min(area, 0.98)) / kUnit + 0.5));
#ifdef NEAREST
  atomicMin(nearest[index], floatBitsToUint(depth));  // positive floats order as their bits do
#endif
}

void main() {
  uint point = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationID.x;
  if (point + 1u >= pointCount) return;
  if (strandPoints[point].seed != strandPoints[point + 1u].seed) return;  // the end of a strand
  vec4 a = clipFromWorld * vec4(strandPoints[point].positionWidth.xyz, 1);
  vec4 b = clipFromWorld * vec4(strandPoints[point + 1u].positionWidth.xyz, 1);
  float widthA = strandPoints[point].positionWidth.w, widthB = strandPoints[point + 1u].positionWidth.w;
  float near = viewForward.w;
  if (!(a.w >= near || b.w >= near)) return;
  if (a.w < near) { float t = (near - a.w) / (b.w - a.w); a = mix(a, b, t); widthA = mix(widthA, widthB, t); }
  if (b.w < near) { float t = (near - b.w) / (a.w - b.w); b = mix(b, a, t); widthB = mix(widthB, widthA, t); }
  vec3 pa = vec3((0.5 * a.xy / a.w + 0.5) * viewport.xy, widthA / (eye.w * a.w));
  vec3 pb = vec3((0.5 * b.xy / b.w + 0.5) * viewport.xy, widthB / (eye.w * b.w));
  bool steep = abs(pb.y - pa.y) > abs(pb.x - pa.x);
  vec2 size = viewport.xy;
  if (steep) { pa.xy = pa.yx; pb.xy = pb.yx; size = size.yx; }
  float depthA = a.w, depthB = b.w;
  if (pa.x > pb.x) { vec3 p = pa; pa = pb; pb = p; float d = depthA; depthA = depthB; depthB = d; }
  float span = pb.x - pa.x;
  if (!(span > 1e-6)) return;
  float stretch = length(pb.xy - pa.xy) / span;  // length of ribbon a column
  int last = int(min(floor(pb.x), size.x - 1.0));
  for (int column = int(max(floor(pa.x), 0.0)); column <= last; ++column) {
    float from = max(pa.x, float(column)), to = min(pb.x, float(column) + 1.0);
    vec3 middle = mix(pa, pb, (0.5 * (from + to) - pa.x) / span);
    float area = (to - from) * stretch * middle.z;
    float row = floor(middle.y - 0.5), part = middle.y - 0.5 - row;
    float depth = mix(depthA, depthB, (middle.x - pa.x) / span);
    ivec2 pixel = ivec2(column, int(row));
    put(steep ? pixel.yx : pixel, area * (1.0 - part), depth);
    pixel.y += 1;
    put(steep ? pixel.yx : pixel, area * part, depth);
  }
}
