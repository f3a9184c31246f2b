// Edges as quads of constant width in pixels (mode 0), faces as triangles (mode 1).
#include "frame.glsl"
struct OverlayVertex {
  vec4 position;   // w unused
  vec4 color;
};
layout(std430, binding = 0) readonly buffer OverlayVertices { OverlayVertex vertices[]; };
layout(location = 0) uniform int mode;
layout(location = 1) uniform float edgePixels;
out vec4 tint;
void main() {
  if (mode == 1) {
    tint = vertices[gl_VertexID].color;
    gl_Position = clipFromWorld * vec4(vertices[gl_VertexID].position.xyz, 1);
    return;
  }
  int corner = gl_VertexID % 6;
  int end = (corner == 1 || corner == 2 || corner == 4) ? 1 : 0;
  float side = (corner == 2 || corner == 4 || corner == 5) ? 1.0 : -1.0;
  int first = 2 * (gl_VertexID / 6);
  vec3 a = vertices[first].position.xyz, b = vertices[first + 1].position.xyz;
  vec3 p = end == 1 ? b : a;
  vec3 toEye = eye.xyz - p;
  vec3 across = cross(b - a, toEye);
  float acrossLength = length(across);
  across = acrossLength > 0.0 ? across / acrossLength : vec3(0);
  float pixel = eye.w * max(-dot(toEye, viewForward.xyz), viewForward.w);
  tint = vertices[first + end].color;
  gl_Position = clipFromWorld * vec4(p + across * side * 0.5 * edgePixels * pixel, 1);
  gl_Position.z -= 2e-4 * gl_Position.w;
}
