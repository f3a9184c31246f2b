// Points and strip indices of all strands of a batch, one invocation a point.
#define COMPUTE
#define SYNTHESISE_IN_PLACE
#include "strand_buffer.glsl"
layout(local_size_x = 64) in;
layout(std430, binding = 0) writeonly buffer StrandPoints { PackedPoint strandPoints[]; };
layout(std430, binding = 7) writeonly buffer Indices { uint indices[]; };
layout(location = 0) uniform uint pointCount;
layout(location = 1) uniform uint firstIndex;
layout(location = 2) uniform int topology;    // 0 a ribbon a strand, 1 a strip of lines, 2 a line a segment

void main() {
  uint point = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationID.x;
  if (point >= pointCount) return;
  Place place = placeOf(point);
  strandPoints[point] = packPoint(synthesise(place));
  if (topology == 2) {
    bool first = place.sampleIndex == 0u;
    for (uint k = 0u; k < 2u; ++k) indices[firstIndex + 2u * point + k] = first ? 0xffffffffu : 2u * point + k;
    return;
  }
  uint width = topology == 1 ? 1u : 2u;
  uint index = firstIndex + width * point + shares[place.share].strandStart + place.strand;
  for (uint k = 0u; k < width; ++k) indices[index + k] = width * point + k;
  if (place.sampleIndex + 1u == shares[place.share].samples) indices[index + width] = 0xffffffffu;
}
