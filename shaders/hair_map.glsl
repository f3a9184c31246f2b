// How the key light sees the hair: LightView's projection and the layers of the map (src/preview/hair_map.h).
layout(std140, binding = 1) uniform HairMap {
  mat4 mapFromWorld;   // xy in texels, z depth, all times w; w = depth for a point light, else 1
  vec4 mapInfo;        // texels a side, nearest depth, width of a texel (point light: at depth 1), opacity of a hair
  ivec4 mapCounts;     // layers or slices; first slice of this pass; rule past the last layer; 1 = point light
  vec4 mapEnds[4];     // of deep layers behind the first hair
};
const int kIgnorePast = 0, kAddToLast = 1, kEnlargeLast = 2;
const float kEmpty = 1e38;       // a nearest depth beyond this: no hair

// Least and greatest depth of all fragments, as ordered integers, and the greatest extent of a texel. WHOLE_RANGE is
// its access: `readonly`, or `coherent`.
#ifdef WHOLE_RANGE
layout(std430, binding = 3) WHOLE_RANGE buffer MapRange { uint wholeNear, wholeFar, greatestExtent; };
#endif
uint orderedBits(float v) {
  uint bits = floatBitsToUint(v);
  return (bits & 0x80000000u) != 0u ? ~bits : bits | 0x80000000u;
}
float fromOrderedBits(uint bits) {
  return uintBitsToFloat((bits & 0x80000000u) != 0u ? bits ^ 0x80000000u : ~bits);
}

// xy in texels, z depth; w <= 0: behind a point light.
vec4 mapProject(vec3 p) {
  vec4 h = mapFromWorld * vec4(p, 1);
  return vec4(h.xy / h.w, h.z, h.w);
}
float texelAt(float depth) { return mapCounts.w == 1 ? mapInfo.z * depth : mapInfo.z; }
int sliceCount() { return mapCounts.x; }

// −log1p(−α); the series where 1 − α would lose α's digits.
float opticalDepthOf(float a) {
  return a < 0.02 ? a * (1.0 + a * (0.5 + a * (0.33333333 + 0.25 * a))) : -log(1.0 - a);
}

// Where in its range a depth lies.
int sliceOf(float d, float extent, int slices) {
  return extent > 0.0 ? int(clamp(d / extent * float(slices), 0.0, float(slices) - 1.0)) : 0;
}
#ifdef WHOLE_RANGE
// Opacity shadow maps: slices of equal thickness over the whole hair.
float wholeExtent() {
  float extent = (fromOrderedBits(wholeFar) - fromOrderedBits(wholeNear)) * (1.0 + 1e-6);
  return extent > 0.0 ? extent : max(1e-6 * mapInfo.x * mapInfo.z, 1e-12);
}
// Deep opacity maps: the last layer may reach to the end of the hair.
float layerEnd(int k) {
  float end = mapEnds[k >> 2][k & 3];
  bool enlarge = k == mapCounts.x - 1 && mapCounts.z == kEnlargeLast;
  return enlarge ? max(end, uintBitsToFloat(greatestExtent) * (1.0 + 1e-6)) : end;
}
#else
float layerEnd(int k) { return mapEnds[k >> 2][k & 3]; }
#endif
