// Points and strip indices of all strands of a batch, one invocation a point.
#define COMPUTE
#define SYNTHESISE_IN_PLACE
#include "strand_buffer.glsl"
#include "strand_indices.glsl"
layout(local_size_x = 64) in;
layout(std430, binding = 0) writeonly buffer StrandPoints { PackedPoint strandPoints[]; };
layout(location = 0) uniform uint pointCount;

void main() {
  uint point = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationID.x;
  if (point >= pointCount) return;
  Place place = placeOf(point);
  Share share = shares[place.share];
  strandPoints[point] = packPoint(synthesise(place));
  writeIndices(point, share.strandStart + place.strand, place.sampleIndex == 0u,
               place.sampleIndex + 1u == share.samples);
}
