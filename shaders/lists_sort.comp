// Sorts each list, nearest first (heap sort: in place, and no worse for long lists). For maps amounts become their sums.
#include "lists.glsl"
layout(local_size_x = 64) in;
layout(location = 0) uniform uint listCount;

void siftDown(uint begin, uint root, uint count) {
  Entry moving = entries[begin + root];
  for (uint child = 2u * root + 1u; child < count; child = 2u * root + 1u) {
    if (child + 1u < count && before(entries[begin + child], entries[begin + child + 1u])) ++child;
    if (!before(moving, entries[begin + child])) break;
    entries[begin + root] = entries[begin + child];
    root = child;
  }
  entries[begin + root] = moving;
}

void main() {
  uint list = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationID.x;
  if (list >= listCount) return;
  uint begin = starts[list], count = starts[list + 1u] - begin;
  for (uint root = count / 2u; root > 0u; --root) siftDown(begin, root - 1u, count);
  for (uint last = count; last > 1u; --last) {
    Entry greatest = entries[begin];
    entries[begin] = entries[begin + last - 1u];
    entries[begin + last - 1u] = greatest;
    siftDown(begin, 0u, last - 1u);
  }
#ifndef LIST_OF_EYE
  for (uint i = 1u; i < count; ++i) entries[begin + i].amount += entries[begin + i - 1u].amount;
#endif
}
