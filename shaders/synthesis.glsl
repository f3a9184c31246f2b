// A strand from the hair mesh: Σ λ_i C_i with C_i the spline through column i of its bundle, sampled once a bundle
// by strand_columns.comp (include/coif/strands/sampler.h is the same on the CPU). Or, with IMPORTED, every so many
// points of a strand that came as points. Mirrors src/preview/hair_model.h and detail.h.
struct Lock {            // strands that share their number of samples: those of a bundle
  uint corners, height;  // IMPORTED: 0, 0
  uint vertexStart;      // into bundleVertices, layer by layer
  uint rootStart;        // its first strand
};
struct Share {           // what one picture draws of a lock
  uint lock, firstStrand, strands, samples;
  uint pointStart, strandStart, parameterStart, columnStart;
};
struct Root {
  vec4 positionWidth;    // where it starts, on the head; diameter there
  float tipWidth;
  uint seed;
  uint first, count;     // weights, or IMPORTED: points
};
struct ColumnSample {
  vec4 position;         // w: corner 0: how much of the lift is left here; corner 1: 0 at the root … 1 at the tip
  vec4 difference;       // next sample less the one before; w: corner 0: of the lift
};
layout(std430, binding = 1) readonly buffer Locks { Lock locks[]; };
layout(std430, binding = 2) readonly buffer Shares { Share shares[]; };
layout(std430, binding = 3) readonly buffer Roots { Root roots[]; };
#ifdef IMPORTED
layout(std430, binding = 4) readonly buffer RawPoints { vec4 rawPoints[]; };  // diameter in w
#else
layout(std430, binding = 4) readonly buffer Weights { float weights[]; };
layout(std430, binding = 6) readonly buffer Columns { ColumnSample columns[]; };
#endif
layout(std430, binding = 5) readonly buffer Colors { vec4 colors[]; };  // a strand, IMPORTED: a point
layout(location = 10) uniform uint firstShare;
layout(location = 11) uniform uint shareCount;
layout(location = 12) uniform float widthScale;
layout(location = 13) uniform bool colored;

#ifdef STYLED
layout(location = 14) uniform uint curvePoints;  // samples of the columns: a strand's points at full detail
#endif

struct Place { uint share, strand, sampleIndex; };

// The share that holds a point of the batch: the last that starts at or before it.
Place placeOf(uint point) {
  uint low = firstShare, high = firstShare + shareCount;
  while (high - low > 1u) {
    uint middle = (low + high) >> 1u;
    if (shares[middle].pointStart <= point) low = middle; else high = middle;
  }
  uint within = point - shares[low].pointStart, samples = shares[low].samples;
  return Place(low, within / samples, within % samples);
}

vec3 direction(vec3 d) {
  float size = max(abs(d.x), max(abs(d.y), abs(d.z)));
  return size > 0.0 ? normalize(d / size) : vec3(0);
}

// Which of a strand's points is sample k of a few.
uint pointTaken(uint k, uint samples, uint points) {
  return samples >= points ? min(k, points - 1u)
                           : (2u * k * (points - 1u) + samples - 1u) / (2u * (samples - 1u));
}

#ifdef STYLED
#elif defined(IMPORTED)
StrandPoint synthesise(Place place) {
  Share share = shares[place.share];
  Root root = roots[locks[share.lock].rootStart + share.firstStrand + place.strand];
  uint last = root.count - 1u;
  uint i = pointTaken(place.sampleIndex, share.samples, root.count);
  vec4 here = rawPoints[root.first + i];
  vec3 d = rawPoints[root.first + min(i + 1u, last)].xyz - rawPoints[root.first + max(i, 1u) - 1u].xyz;
  vec3 color = colored ? colors[root.first + i].rgb : vec3(0);
  return StrandPoint(vec4(here.xyz, here.w * widthScale), vec4(direction(d), uintBitsToFloat(root.seed)),
                     vec4(color, float(i) / float(last)));
}
#else
StrandPoint synthesise(Place place) {
  Share share = shares[place.share];
  uint strand = locks[share.lock].rootStart + share.firstStrand + place.strand;
  Root root = roots[strand];
  uint column = share.columnStart;
  vec3 start = vec3(0), position = vec3(0), difference = vec3(0);
  for (uint c = 0u; c < root.count; ++c, column += share.samples) {
    float w = weights[root.first + c];
    start += w * columns[column].position.xyz;
    position += w * columns[column + place.sampleIndex].position.xyz;
    difference += w * columns[column + place.sampleIndex].difference.xyz;
  }
  uint at = share.columnStart + place.sampleIndex;
  vec3 lift = root.positionWidth.xyz - start;
  position = place.sampleIndex == 0u ? root.positionWidth.xyz : position + columns[at].position.w * lift;
  difference += columns[at].difference.w * lift;
  float along = columns[at + share.samples].position.w;
  vec3 color = colored ? colors[strand].rgb : vec3(0);
  return StrandPoint(vec4(position, mix(root.positionWidth.w, root.tipWidth, along) * widthScale),
                     vec4(direction(difference), uintBitsToFloat(root.seed)), vec4(color, along));
}
#endif
