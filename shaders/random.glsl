// PCG-style hash: three integers to a number in [0, 1). The same on every machine.
uint hash3(uvec3 v) {
  v = v * 1664525u + 1013904223u;
  v.x += v.y * v.z; v.y += v.z * v.x; v.z += v.x * v.y;
  v ^= v >> 16u;
  v.x += v.y * v.z; v.y += v.z * v.x; v.z += v.x * v.y;
  return v.x ^ v.z;
}
float random3(uint a, uint b, uint c) { return float(hash3(uvec3(a, b, c)) >> 8u) * (1.0 / 16777216.0); }
