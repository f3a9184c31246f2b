// One record a strand point; the index names (point, side): vertex v is side v & 1 of point v >> 1.
struct StrandPoint {
  vec4 positionWidth;   // diameter in w
  vec4 tangentSeed;     // unit tangent; strand seed as bits in w
  vec4 colorAlong;      // linear RGB; 0 at the root … 1 at the tip
};
layout(std430, binding = 0) readonly buffer StrandPoints { StrandPoint strandPoints[]; };
