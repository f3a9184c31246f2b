// Hairs as lines on the light's map: one fragment a step along the major axis (include/coif/light/fragments.h).
// Drivers differ in who owns the ends of a line, so it is drawn a step longer at both, and the fragment shader keeps
// the steps whose centres lie in the segment.
#define COMPUTE                // picks its own points
#include "hair_map.glsl"
#include "strand_buffer.glsl"
flat out vec4 ends;            // on the map, in texels
flat out vec4 depthWidth;      // depths and widths at the ends
void main() {
#ifdef SLICED
  int point = int(slicedSegments[gl_VertexID >> 1]) + 1;
#else
  int point = gl_VertexID >> 1;
#endif
  StrandPoint p = strandPointAt(max(point - 1, 0)), q = strandPointAt(point);
  vec4 a = mapProject(p.positionWidth.xyz), b = mapProject(q.positionWidth.xyz);
  // Cut where the light is nearer than it can see.
  float span = b.z - a.z, cutA = 0.0, cutB = 1.0;
  if (mapCounts.w == 1 && min(a.z, b.z) < mapInfo.y) {
    float cut = clamp((mapInfo.y - a.z) / (span != 0.0 ? span : 1.0), 0.0, 1.0);
    if (a.z < mapInfo.y) cutA = cut;
    if (b.z < mapInfo.y) cutB = cut;
    vec3 from = p.positionWidth.xyz, along = q.positionWidth.xyz - from;
    a = mapProject(from + cutA * along), b = mapProject(from + cutB * along);
  }
  bool hidden = mapCounts.w == 1 && max(a.z, b.z) < 1.5 * mapInfo.y;
  vec2 d = b.xy - a.xy;
  float major = max(abs(d.x), abs(d.y));
  vec2 step = major > 0.0 ? d / major : vec2(0);
  vec2 place = (gl_VertexID & 1) == 0 ? a.xy - step : b.xy + step;
  ends = vec4(a.xy, b.xy);
  depthWidth = vec4(a.z, b.z, mix(vec2(p.positionWidth.w), vec2(q.positionWidth.w), vec2(cutA, cutB)));
  gl_Position = hidden || !(major > 0.0) ? vec4(2, 2, 2, 1) : vec4(place * (2.0 / mapInfo.x) - 1.0, 0, 1);
}
