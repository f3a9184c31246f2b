#include "frame.glsl"
#include "hair_map.glsl"
layout(location = 0) in vec3 position;
void main() {
  vec4 h = mapFromWorld * vec4(position, 1);
  gl_Position = vec4(h.xy * (2.0 / mapInfo.x) - h.w, (2.0 * h.z / shadowInfo.y - 1.0) * h.w, h.w);
}
