// Coverage as a random set of a pixel's samples: floor(coverage n + u) of n, from a random one on; right on average.
// Overlapping hairs then need no sorting. `bits` are random.
int sampleMask(float coverage, uint bits) {
  int n = gl_NumSamples;
  int wanted = min(int(floor(clamp(coverage, 0.0, 1.0) * float(n) + float(bits >> 8u) * (1.0 / 16777216.0))), n);
  int run = (1 << wanted) - 1;
  int first = int(bits & 255u) % n;
  return ((run << first) | (run >> (n - first))) & ((1 << n) - 1);
}
uint fragmentBits(uint name, uint subframe) {
  return hash3(uvec3(uint(gl_FragCoord.y) * 8192u + uint(gl_FragCoord.x), name, subframe));
}
