// Hair as the eye sees it, in layers of depth behind the first hair of each pixel: a layer holds the sum of its hairs'
// optical depths and of their light times those. Layer k is s (k + 1) thick, the last has no end. Sums are whole
// numbers, so that they do not depend on the order in which hairs come: 32 bits, and what they carry over.
const int kLayers = 8;
const float kUnit = 1.0 / 65536.0;
struct Layer {
  uint red, green, blue, depth;   // in units of kUnit
  uint carried;                   // a byte each, of 2³²
};
layout(std430, binding = 1) buffer Nearest { uint nearest[]; };   // bits of the first hair's depth
layout(std430, binding = 2) buffer Layers { Layer layers[]; };
layout(std430, binding = 3) buffer HeadDepths { vec4 headDepths[]; };   // of a pixel's samples
layout(location = 1) uniform int firstRow;      // the rows that the buffers hold
layout(location = 2) uniform int endRow;
layout(location = 3) uniform float layerSize;   // s

uint pixelIndex(ivec2 pixel) { return uint(pixel.y - firstRow) * uint(viewport.x) + uint(pixel.x); }
int layerOf(float behind) {
  return int(min(floor(0.5 * (sqrt(1.0 + 8.0 * behind / layerSize) - 1.0)), float(kLayers - 1)));
}
