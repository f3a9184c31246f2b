// Points and strip indices of all strands of a batch, one invocation a point.
#define SYNTHESISE_IN_PLACE
#include "strand_buffer.glsl"
layout(local_size_x = 64) in;
layout(std430, binding = 0) writeonly buffer StrandPoints { PackedPoint strandPoints[]; };
layout(std430, binding = 7) writeonly buffer Indices { uint indices[]; };
layout(location = 0) uniform uint pointCount;
layout(location = 1) uniform uint firstIndex;

void main() {
  uint point = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationID.x;
  if (point >= pointCount) return;
  Place place = placeOf(point);
  strandPoints[point] = packPoint(synthesise(place));
  uint index = firstIndex + 2u * point + shares[place.share].strandStart + place.strand;
  indices[index] = 2u * point;
  indices[index + 1u] = 2u * point + 1u;
  if (place.sampleIndex + 1u == shares[place.share].samples) indices[index + 2u] = 0xffffffffu;
}
