// All fragments of a texel, or of a pixel, in one array: starts[t] … starts[t + 1] are its own.
#ifdef LIST_OF_EYE
struct Entry { float depth; uint redGreen, blueAlpha; };   // four halves
bool before(Entry a, Entry b) {
  if (a.depth != b.depth) return a.depth < b.depth;
  return a.redGreen != b.redGreen ? a.redGreen < b.redGreen : a.blueAlpha < b.blueAlpha;
}
#else
struct Entry { float depth, amount; };
bool before(Entry a, Entry b) { return a.depth != b.depth ? a.depth < b.depth : a.amount < b.amount; }
#endif
layout(std430, binding = 1) buffer Entries { Entry entries[]; };
layout(std430, binding = 2) readonly buffer Starts { uint starts[]; };
