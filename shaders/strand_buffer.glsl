// Strand points as the passes see them. Passes call strandPointAt(strandVertex()) and know nothing of how points are
// kept or made (synthesis.glsl). Ribbons: vertex v is side v & 1 of point v >> 1. LINES: vertex v is point v; a line is
// a pixel wide, half the vertices and one primitive where a ribbon needs two, and does for hairs that are no wider.
#ifdef SLICED                  // segments in the order of half-angle slices, by their first points
layout(std430, binding = 7) readonly buffer SlicedSegments { uint slicedSegments[]; };
#endif
#ifdef COMPUTE
#elif defined(SLICED)
#ifdef LINES
int sliceCorner() { return gl_VertexID & 1; }
int sliceEntry() { return gl_VertexID >> 1; }
float strandSide() { return 0.0; }
#else                          // two triangles: corners 0 1 2, 2 1 3
int sliceEntry() { return gl_VertexID / 6; }
int sliceCorner() { int c = gl_VertexID % 6; return (c < 3 ? c : c == 3 ? 2 : c == 4 ? 1 : 3) >> 1; }
float strandSide() { int c = gl_VertexID % 6; return c == 0 || c == 2 || c == 3 ? -0.5 : 0.5; }
#endif
int strandVertex() { return int(slicedSegments[sliceEntry()]) + sliceCorner(); }
int shadeOfVertex() { return 2 * int(slicedSegments[sliceEntry()]) + sliceCorner(); }
#elif defined(LINES)
int strandVertex() { return gl_VertexID; }
float strandSide() { return 0.0; }
#else
int strandVertex() { return gl_VertexID >> 1; }
float strandSide() { return (gl_VertexID & 1) == 0 ? -0.5 : 0.5; }
#endif
#if !defined(COMPUTE) && !defined(SLICED)
int shadeOfVertex() { return strandVertex(); }
#endif
struct StrandPoint {
  vec4 positionWidth;   // diameter in w
  vec4 tangentSeed;     // unit tangent, or zero; strand seed as bits in w
  vec4 colorAlong;      // linear RGB; 0 at the root … 1 at the tip
};
struct PackedPoint {
  vec4 positionWidth;
  uint tangent;         // octahedral, 2 × 16 bits
  uint seed;
  uint redGreen;        // 2 × half
  uint blueAlong;
};
const uint kNoTangent = 0x80008000u;  // packSnorm2x16 never makes it

uint packTangent(vec3 t) {
  float size = dot(abs(t), vec3(1));
  if (!(size > 0.0)) return kNoTangent;
  vec2 o = t.xy / size;
  if (t.z < 0.0) o = (1.0 - abs(o.yx)) * mix(vec2(-1), vec2(1), greaterThanEqual(o, vec2(0)));
  return packSnorm2x16(o);
}
vec3 unpackTangent(uint bits) {
  if (bits == kNoTangent) return vec3(0);
  vec2 o = unpackSnorm2x16(bits);
  vec3 t = vec3(o, 1.0 - abs(o.x) - abs(o.y));
  if (t.z < 0.0) t.xy = (1.0 - abs(o.yx)) * mix(vec2(-1), vec2(1), greaterThanEqual(o, vec2(0)));
  return normalize(t);
}
PackedPoint packPoint(StrandPoint p) {
  return PackedPoint(p.positionWidth, packTangent(p.tangentSeed.xyz), floatBitsToUint(p.tangentSeed.w),
                     packHalf2x16(p.colorAlong.xy), packHalf2x16(p.colorAlong.zw));
}
StrandPoint unpackPoint(PackedPoint p) {
  return StrandPoint(p.positionWidth, vec4(unpackTangent(p.tangent), uintBitsToFloat(p.seed)),
                     vec4(unpackHalf2x16(p.redGreen), unpackHalf2x16(p.blueAlong)));
}

#ifdef SYNTHESISE_IN_PLACE
#include "synthesis.glsl"
#ifndef STYLED
StrandPoint strandPointAt(int point) { return synthesise(placeOf(uint(point))); }
#endif
#else
layout(std430, binding = 0) readonly buffer StrandPoints { PackedPoint strandPoints[]; };
StrandPoint strandPointAt(int point) { return unpackPoint(strandPoints[point]); }
#endif
