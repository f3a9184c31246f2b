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

#ifndef PASS_RUNNING
layout(binding = 2) uniform sampler2D mapRange;     // nearest depth, −farthest
vec2 rangeHere() { return texelFetch(mapRange, ivec2(gl_FragCoord.xy), 0).xy; }
#endif

#ifdef PASS_RUNNING
layout(location = 0) out float sum;
void write(float beta) { sum = beta; }
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

void main() {
  float a;
  if (!place(a)) discard;
  write(opticalDepthOf(a));
}
