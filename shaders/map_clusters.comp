// Bins [μ ± √3 σ] of each texel's clusters, cut at the midpoints between neighbouring means and at the ends of the
// texel's range (Mertens et al. 2004, with the order of the bins kept).
#include "hair_map.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 2) uniform sampler2D mapRange;
layout(binding = 5) uniform sampler2DArray mapMeans;               // weights, moments
layout(binding = 6) uniform sampler2DArray mapAmounts;             // amounts, squares
layout(binding = 0, rgba32f) writeonly uniform image2DArray bins;  // from, to, amount

void main() {
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  if (texel.x >= int(mapInfo.x) || texel.y >= int(mapInfo.x)) return;
  vec2 range = texelFetch(mapRange, texel, 0).xy;
  vec4 from = vec4(0), to = vec4(0), amounts = vec4(0);
  if (range.x < kEmpty) {
    vec4 weights = texelFetch(mapMeans, ivec3(texel, 0), 0), moments = texelFetch(mapMeans, ivec3(texel, 1), 0);
    vec4 squares = texelFetch(mapAmounts, ivec3(texel, 1), 0);
    amounts = texelFetch(mapAmounts, ivec3(texel, 0), 0);
    // Where a cluster's bin has to end: half way to the next that is not empty. From the last to the first, since a
    // search ahead by a running index is compiled wrongly by a driver that we met.
    vec4 means = moments / max(weights, 1e-30), highest = vec4(1);
    float nextMean = -1.0;
    for (int k = 3; k >= 0; --k) {
      if (nextMean >= 0.0) highest[k] = 0.5 * (means[k] + nextMean);
      if (weights[k] > 0.0) nextMean = means[k];
    }
    float lowest = 0.0;
    for (int k = 0; k < 4; ++k) {
      if (!(weights[k] > 0.0)) continue;
      float reach = amounts[k] > 0.0 ? 1.7320508 * sqrt(squares[k] / amounts[k]) : 0.0;
      from[k] = range.x + max(means[k] - reach, lowest) * (-range.y - range.x);
      to[k] = range.x + min(means[k] + reach, highest[k]) * (-range.y - range.x);
      lowest = highest[k];
    }
  }
  imageStore(bins, ivec3(texel, 0), from);
  imageStore(bins, ivec3(texel, 1), to);
  imageStore(bins, ivec3(texel, 2), amounts);
}
