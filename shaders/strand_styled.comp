// Strands on a hair mesh with what styling adds, one invocation a strand: a walk along the strand's curve with its
// frame, C(p·reach) + F(p·reach) · offset (include/coif/strands/strand_style.h is the same on the CPU).
#define COMPUTE
#define STYLED
#define SYNTHESISE_IN_PLACE
#include "strand_buffer.glsl"
#include "strand_indices.glsl"
#include "frames.glsl"
layout(local_size_x = 64) in;
layout(std430, binding = 0) writeonly buffer StrandPoints { PackedPoint strandPoints[]; };
layout(std430, binding = 8) readonly buffer Style { vec4 style[]; };  // src/preview/hair_model.h: prepareStyle
layout(location = 0) uniform uint strandCount;
layout(location = 3) uniform uint lockCount;

Share share;
Root root;
uint strandIndex, strandInBatch, styleStart;
vec3 lift;

vec3 curveAt(uint i) {
  if (i == 0u) return root.positionWidth.xyz;
  vec3 sum = vec3(0);
  uint column = share.columnStart + i;
  for (uint c = 0u; c < root.count; ++c, column += curvePoints) sum += weights[root.first + c] * columns[column].position.xyz;
  return sum + columns[share.columnStart + i].position.w * lift;
}
uint curvePoint(uint k) { return pointTaken(k, share.samples, curvePoints); }
vec3 offsetAt(uint i) { return i == 0u ? vec3(0) : style[styleStart + i].xyz; }

// Samples wait for the next one, as their tangents lie between their neighbours.
uint made = 0u;
vec3 before, here;
void write(vec3 tangent) {
  uint k = made - 1u, i = curvePoint(k), last = curvePoints - 1u;
  float along = columns[share.columnStart + curvePoints + i].position.w;
  float width = mix(root.positionWidth.w, root.tipWidth, along) * style[styleStart + i].w * widthScale;
  uint point = share.pointStart + (strandInBatch - share.strandStart) * share.samples + k;
  vec3 color = colored ? colors[strandIndex].rgb : vec3(0);
  strandPoints[point] = packPoint(StrandPoint(vec4(here, width), vec4(direction(tangent), uintBitsToFloat(root.seed)),
                                              vec4(color, along)));
  writeIndices(point, strandInBatch, k == 0u, k + 1u == share.samples);
}
void add(vec3 position) {
  if (made > 0u) write(position - before);
  before = made > 0u ? here : position;
  here = position;
  ++made;
}

// Uniform Catmull–Rom with pinned ends, between b and c.
vec3 spline(vec3 a, vec3 b, vec3 c, vec3 d, float t) {
  return b + 0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a)));
}

void main() {
  strandInBatch = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationID.x;
  if (strandInBatch >= strandCount) return;
  uint low = firstShare, high = firstShare + shareCount;
  while (high - low > 1u) {
    uint middle = (low + high) >> 1u;
    if (shares[middle].strandStart <= strandInBatch) low = middle; else high = middle;
  }
  share = shares[low];
  uint within = share.firstStrand + strandInBatch - share.strandStart;
  strandIndex = locks[share.lock].rootStart + within;
  root = roots[strandIndex];
  styleStart = lockCount + (uint(style[share.lock].x) + within) * curvePoints;
  float reach = style[styleStart].x, turn = style[styleStart].y;
  vec3 start = vec3(0);
  for (uint c = 0u; c < root.count; ++c) start += weights[root.first + c] * columns[share.columnStart + c * curvePoints].position.xyz;
  lift = root.positionWidth.xyz - start;

  uint last = curvePoints - 1u;
  vec3 a = curveAt(0u), b = a, c = a, d = curveAt(1u), tangent = d - c;
  for (uint i = 1u; tangent == vec3(0) && i < last; ++i) tangent = curveAt(i + 1u) - curveAt(i);
  ColumnSample face = columns[share.columnStart + root.count * curvePoints];
  Frame frame = Frame(face.position.xyz, face.difference.xyz), last_ = frame;
  if (tangent != vec3(0)) {
    frame = turnedTo(frame, tangent);
    frame.normal = cos(turn) * frame.normal + sin(turn) * binormal(frame);
  }
  bool started = d != c;
  add(c);  // the first point is never moved
  for (uint j = 1u; j <= last; ++j) {
    a = b, b = c, c = d;
    d = j < last ? curveAt(j + 1u) : c;
    vec3 left = j > 1u ? a : 2.0 * b - c, right = j < last ? d : 2.0 * c - b;
    last_ = frame;
    tangent = direction(d - b);
    if (started) {
      frame = transported(frame, c - b, tangent);
    } else if (tangent != vec3(0)) {
      frame = turnedTo(frame, tangent);
      started = true;
    }
    for (; made < share.samples; ) {
      uint i = curvePoint(made);
      float place = float(i) * reach;
      if (place > float(j)) break;
      float t = clamp(place - float(j - 1u), 0.0, 1.0);
      Frame at = t < 0.5 ? last_ : frame;
      vec3 between = mix(last_.tangent, frame.tangent, t);
      if (t > 0.0 && t < 1.0 && dot(between, between) > 1e-12) at = turnedTo(at, between);
      add((t == 1.0 ? c : spline(left, b, c, right, t)) + inSpace(at, offsetAt(i)));
    }
  }
  float lastStep = distance(c, b);
  while (made < share.samples) {  // beyond its curve a strand goes straight on
    uint i = curvePoint(made);
    add(c + (float(i) * reach - float(last)) * lastStep * frame.tangent + inSpace(frame, offsetAt(i)));
  }
  write(here - before);
}
