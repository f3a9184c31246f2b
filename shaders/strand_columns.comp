// Samples the columns of bundles, one work group a share: Catmull–Rom with pinned ends as cubic Hermite segments
// over knot intervals (include/coif/strands/catmull_rom.h has the sources). STYLED: at all points of a strand at full
// detail, and behind the last column the frame of the root face: tangent and normal.
struct Lock { uint corners, height, vertexStart, rootStart; };
struct Share {
  uint lock, firstStrand, strands, samples;
  uint pointStart, strandStart, parameterStart, columnStart;
};
struct ColumnSample { vec4 position, difference; };
layout(local_size_x = 64) in;
layout(std430, binding = 1) readonly buffer Locks { Lock locks[]; };
layout(std430, binding = 2) readonly buffer Shares { Share shares[]; };
layout(std430, binding = 3) readonly buffer Vertices { vec4 vertices[]; };
layout(std430, binding = 4) readonly buffer BundleVertices { uint bundleVertices[]; };
layout(std430, binding = 5) readonly buffer Parameters { float parameters[]; };
layout(std430, binding = 6) writeonly buffer Columns { ColumnSample columns[]; };
layout(location = 0) uniform uint shareCount;
layout(location = 1) uniform int knots;  // 0 uniform, 1 centripetal, 2 chordal
#ifdef STYLED
layout(location = 14) uniform uint curvePoints;
uint samplesOf(Share share) { return curvePoints; }
#else
uint samplesOf(Share share) { return share.samples; }
#endif

vec3 control(Lock lock, uint corner, uint layer) {
  return vertices[bundleVertices[lock.vertexStart + layer * lock.corners + corner]].xyz;
}
float layerLength(Lock lock, uint k) {
  float sum = 0.0;
  for (uint i = 0u; i < lock.corners; ++i) sum += distance(control(lock, i, k + 1u), control(lock, i, k));
  return sum;
}
float interval(Lock lock, uint k, float total) {
  if (knots == 0 || !(total > 0.0)) return 1.0;
  float part = max(layerLength(lock, k) / total, 1e-6);
  return knots == 2 ? part : sqrt(part);
}

vec3 columnAt(Lock lock, uint corner, float t, float total) {
  uint last = lock.height - 1u, k = min(uint(t), last);
  float u = clamp(t - float(k), 0.0, 1.0);
  vec3 p1 = control(lock, corner, k), p2 = control(lock, corner, k + 1u);
  if (u == 0.0) return p1;
  if (u == 1.0) return p2;
  vec3 p0 = k > 0u ? control(lock, corner, k - 1u) : 2.0 * p1 - p2;
  vec3 p3 = k < last ? control(lock, corner, k + 2u) : 2.0 * p2 - p1;
  float own = interval(lock, k, total);
  float before = k > 0u ? interval(lock, k - 1u, total) : own, after = k < last ? interval(lock, k + 1u, total) : own;
  vec3 m1 = own * ((p1 - p0) / before - (p2 - p0) / (before + own) + (p2 - p1) / own);
  vec3 m2 = own * ((p2 - p1) / own - (p3 - p1) / (own + after) + (p3 - p2) / after);
  return p1 + u * u * (3.0 - 2.0 * u) * (p2 - p1) + u * (1.0 - u) * (1.0 - u) * m1 + u * u * (u - 1.0) * m2;
}

// (1−u)²(1+2u) over the first segment.
float fading(float t) { return t < 1.0 ? (1.0 - t) * (1.0 - t) * (1.0 + 2.0 * t) : 0.0; }

#ifdef STYLED
// As faceFrame() of include/coif/strands/frames.h.
ColumnSample faceFrame(Lock lock) {
  vec3 origin = control(lock, 0u, 0u), area = vec3(0), first = control(lock, 1u, 0u) - origin;
  for (uint i = 1u; i + 1u < lock.corners; ++i)
    area += cross(control(lock, i, 0u) - origin, control(lock, i + 1u, 0u) - origin);
  float size = length(area);
  if (!(size > 0.0)) return ColumnSample(vec4(0, 0, 1, 0), vec4(1, 0, 0, 0));
  vec3 tangent = area / size, side = first - dot(first, tangent) * tangent;
  if (!(length(side) > 1e-6 * sqrt(size)))
    side = abs(tangent.z) > 0.9 ? vec3(0, -tangent.z, tangent.y) : vec3(-tangent.y, tangent.x, 0);
  side -= dot(side, tangent) * tangent;
  return ColumnSample(vec4(tangent, 0), vec4(normalize(side), 0));
}
#endif

void main() {
  uint index = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  if (index >= shareCount) return;
  Share share = shares[index];
  Lock lock = locks[share.lock];
  float total = 0.0;
  for (uint k = 0u; knots != 0 && k < lock.height; ++k) total += layerLength(lock, k);
  uint samples = samplesOf(share);
#ifdef STYLED
  if (gl_LocalInvocationID.x == 0u) columns[share.columnStart + lock.corners * samples] = faceFrame(lock);
#endif
  for (uint i = gl_LocalInvocationID.x; i < lock.corners * samples; i += gl_WorkGroupSize.x) {
    uint corner = i / samples, s = i % samples;
    float t = parameters[share.parameterStart + s];
    float before = parameters[share.parameterStart + max(s, 1u) - 1u];
    float after = parameters[share.parameterStart + min(s + 1u, samples - 1u)];
    columns[share.columnStart + i].position =
        vec4(columnAt(lock, corner, t, total), corner == 0u ? fading(t) : t / float(lock.height));
    columns[share.columnStart + i].difference =
        vec4(columnAt(lock, corner, after, total) - columnAt(lock, corner, before, total),
             fading(after) - fading(before));
  }
}
