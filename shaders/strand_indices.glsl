// The strips or lines of a batch's strands, one point at a time.
layout(std430, binding = 7) writeonly buffer Indices { uint indices[]; };
layout(location = 1) uniform uint firstIndex;
layout(location = 2) uniform int topology;    // 0 a ribbon a strand, 1 a strip of lines, 2 a line a segment

// `strand` counts within the batch.
void writeIndices(uint point, uint strand, bool first, bool last) {
  if (topology == 2) {
    for (uint k = 0u; k < 2u; ++k) indices[firstIndex + 2u * point + k] = first ? 0xffffffffu : 2u * point + k;
    return;
  }
  uint width = topology == 1 ? 1u : 2u;
  uint index = firstIndex + width * point + strand;
  for (uint k = 0u; k < width; ++k) indices[index + k] = width * point + k;
  if (last) indices[index + width] = 0xffffffffu;
}
