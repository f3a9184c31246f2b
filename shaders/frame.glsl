// What every pass of a picture knows. Mirrors FrameData in src/preview/frame_data.h; std140, vec4s only.
layout(std140, binding = 0) uniform Frame {
  mat4 clipFromWorld;       // with the sub-frame's jitter
  vec4 eye;                 // xyz; w = world size of a pixel at distance 1
  vec4 viewForward;         // xyz; w = near distance
  vec4 viewUp;              // xyz
  vec4 viewport;            // width, height, sub-frame, 1 = transparent background
  vec4 lightDirection[3];   // key, fill, rim: to the light
  vec4 lightColor[3];
  vec4 skyColor;
  vec4 groundColor;
  vec4 volumeLo;            // xyz; w = cell
  vec4 volumeScale;         // xyz = 1 / extent
  vec4 shadowInfo;          // 1 = filtered look-ups, depth range (world), texel (world), bias (world)
  vec4 hairColor;           // w = 1: the strands carry colours
  vec4 headColor;
  vec4 hairPasses;          // RGB: the part of what meets a hair that goes on; 0 where that is not asked for
  vec4 backgroundTop;
  vec4 backgroundBottom;
};
