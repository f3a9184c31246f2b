// Segments in slices across the half vector of light and eye: counted by work group, then (SCATTER) put in place. Within
// a slice they keep the order of the strands, so that a picture has the same bytes every time.
#define COMPUTE
#include "strand_buffer.glsl"
layout(local_size_x = 256) in;
layout(location = 0) uniform uint pointCount;
layout(location = 1) uniform vec3 away;        // from light and eye, over a slice's thickness
layout(location = 2) uniform float first;      // where the first slice begins
layout(location = 3) uniform uint sliceCount;
const uint kNoSlice = 0xffffffffu;
#ifdef SCATTER
layout(std430, binding = 5) readonly buffer Places { uint places[]; };
layout(std430, binding = 7) writeonly buffer SlicedSegments { uint slicedSegments[]; };
#else
layout(std430, binding = 5) writeonly buffer Counts { uint counts[]; };   // by slice, then work group
#endif
shared uint slices[256];

// A segment is drawn once both its ends are lit.
uint sliceOf(uint point) {
  if (point + 1u >= pointCount || strandPoints[point].seed != strandPoints[point + 1u].seed) return kNoSlice;
  float d = max(dot(away, strandPoints[point].positionWidth.xyz), dot(away, strandPoints[point + 1u].positionWidth.xyz));
  return uint(clamp(d - first, 0.0, float(sliceCount - 1u)));
}

void main() {
  uint groups = gl_NumWorkGroups.x * gl_NumWorkGroups.y;
  uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x, at = gl_LocalInvocationID.x;
  uint point = group * 256u + at;
  slices[at] = sliceOf(point);
  barrier();
#ifdef SCATTER
  uint own = slices[at], before = 0u;
  if (own == kNoSlice) return;
  for (uint i = 0u; i < at; ++i) before += slices[i] == own ? 1u : 0u;
  slicedSegments[places[own * groups + group] + before] = point;
#else
  for (uint s = at; s < sliceCount; s += 256u) {
    uint count = 0u;
    for (uint i = 0u; i < 256u; ++i) count += slices[i] == s ? 1u : 0u;
    counts[s * groups + group] = count;
  }
#endif
}
