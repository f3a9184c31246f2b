// One fragment of a hair on the light's map; what it leaves there depends on the pass.
#include "hair_map.glsl"
flat in vec4 ends;
flat in vec4 depthWidth;
float depth;

// False outside the segment. Depth and width are linear in space.
bool place(out float alpha) {
  vec2 d = ends.zw - ends.xy;
  bool alongX = abs(d.x) >= abs(d.y);
  float at = alongX ? gl_FragCoord.x - ends.x : gl_FragCoord.y - ends.y, major = alongX ? d.x : d.y;
  float u = at / major, slope = (alongX ? d.y : d.x) / major;
  if (major > 0.0 ? at < 0.0 || at >= major : at < major || at >= 0.0) return false;   // the lower end belongs to it
  u = clamp(u, 0.0, 1.0);
  float t = mapCounts.w == 1 ? u * depthWidth.x / (depthWidth.y * (1.0 - u) + u * depthWidth.x) : u;
  depth = mix(depthWidth.x, depthWidth.y, t);
  float width = mix(depthWidth.z, depthWidth.w, t);
  alpha = min(mapInfo.w * width * sqrt(1.0 + slope * slope) / texelAt(depth), 0.99999994);
  return alpha > 0.0;
}
// −log1p(−α); the series where 1 − α would lose α's digits.
float opticalDepthOf(float a) {
  return a < 0.02 ? a * (1.0 + a * (0.5 + a * (0.33333333 + 0.25 * a))) : -log(1.0 - a);
}

#if !defined(PASS_RANGE) && !defined(PASS_COUNT) && !defined(PASS_LIST) && !defined(PASS_RUNNING)
layout(binding = 2) uniform sampler2D mapRange;     // nearest depth, −farthest
vec2 rangeHere() { return texelFetch(mapRange, ivec2(gl_FragCoord.xy), 0).xy; }
#endif

#ifdef PASS_RANGE
layout(location = 0) out vec2 range;
void write(float beta) { range = vec2(depth, -depth); }
#endif

#ifdef PASS_RUNNING
layout(location = 0) out float sum;
void write(float beta) { sum = beta; }
#endif

#ifdef PASS_OPACITY
layout(location = 0) out vec4 sums[8];
void write(float beta) {
  float d = depth - fromOrderedBits(wholeNear), step = wholeExtent() / float(mapCounts.x);
  for (int t = 0; t < 8; ++t) {
    for (int c = 0; c < 4; ++c) {
      int k = mapCounts.y + 4 * t + c;
      sums[t][c] = k >= mapCounts.x - 1 || d < step * float(k + 1) ? beta : 0.0;
    }
  }
}
#endif

#ifdef PASS_DEEP   // how many targets of four layers
layout(location = 0) out vec4 sums[PASS_DEEP];
void write(float beta) {
  float d = depth - rangeHere().x;
  for (int t = 0; t < PASS_DEEP; ++t) {
    for (int c = 0; c < 4; ++c) {
      int k = 4 * t + c;
      bool inFront = k < mapCounts.x && (d < layerEnd(k) || (k == mapCounts.x - 1 && mapCounts.z == kAddToLast));
      sums[t][c] = inFront ? beta : 0.0;
    }
  }
}
#endif

#if defined(PASS_MEANS) || defined(PASS_CLUSTERS)
float relativeDepth(vec2 range) {
  float extent = -range.y - range.x;
  return extent > 0.0 ? (depth - range.x) / extent : 0.0;
}
vec4 only(int k, float v) { return v * vec4(equal(ivec4(k), ivec4(0, 1, 2, 3))); }
#endif

#ifdef PASS_MEANS
layout(location = 0) out vec4 weights;
layout(location = 1) out vec4 moments;
void write(float beta) {
  float d = relativeDepth(rangeHere());
  int nearest = min(int(d * 4.0), 3);
  weights = only(nearest, beta);
  moments = only(nearest, beta * d);
}
#endif

#ifdef PASS_CLUSTERS
layout(binding = 5) uniform sampler2DArray mapMeans;   // weights, moments
layout(location = 0) out vec4 amounts;
layout(location = 1) out vec4 squares;
void write(float beta) {
  ivec2 here = ivec2(gl_FragCoord.xy);
  vec4 w = texelFetch(mapMeans, ivec3(here, 0), 0), m = texelFetch(mapMeans, ivec3(here, 1), 0);
  float d = relativeDepth(rangeHere()), least = kEmpty, away = 0.0;
  int nearest = 0;
  for (int k = 0; k < 4; ++k) {
    if (!(w[k] > 0.0)) continue;
    float difference = d - m[k] / w[k];
    if (abs(difference) < least) nearest = k, least = abs(difference), away = difference;
  }
  amounts = only(nearest, beta);
  squares = only(nearest, beta * away * away);
}
#endif

#ifdef PASS_OCCUPANCY
layout(binding = 0, r32ui) uniform uimage2DArray mapBits;
layout(location = 0) out vec4 slabs;
void write(float beta) {
  vec2 range = rangeHere();
  int slice = sliceOf(depth - range.x, -range.y - range.x, 128);
  imageAtomicOr(mapBits, ivec3(gl_FragCoord.xy, slice >> 5), 1u << (slice & 31));
  slabs = beta * vec4(equal(ivec4(slice >> 5), ivec4(0, 1, 2, 3)));
}
#endif

#ifdef PASS_COUNT
layout(binding = 1, r32ui) uniform uimage2D listCounts;
void write(float beta) { imageAtomicAdd(listCounts, ivec2(gl_FragCoord.xy), 1u); }
#endif

#ifdef PASS_LIST
#include "lists.glsl"
layout(binding = 1, r32ui) uniform uimage2D listCounts;
void write(float beta) {
  ivec2 here = ivec2(gl_FragCoord.xy);
  uint slot = starts[here.y * int(mapInfo.x) + here.x] + imageAtomicAdd(listCounts, here, 1u);
  entries[slot] = Entry(depth, beta);
}
#endif

void main() {
  float a;
  if (!place(a)) discard;
  write(opticalDepthOf(a));
}
