// A square that holds the disc.
#include "frame.glsl"
layout(location = 0) uniform vec4 groundDisc;     // middle, radius
layout(location = 1) uniform vec3 groundNormal;
out vec3 worldPosition;
void main() {
  vec3 aside = normalize(abs(groundNormal.x) < 0.7 ? cross(groundNormal, vec3(1, 0, 0)) : cross(groundNormal, vec3(0, 1, 0)));
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
  worldPosition = groundDisc.xyz + groundDisc.w * (corner.x * aside + corner.y * cross(groundNormal, aside));
  gl_Position = clipFromWorld * vec4(worldPosition, 1);
}
