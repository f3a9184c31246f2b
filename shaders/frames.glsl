// Frames along a strand, as include/coif/strands/frames.h has them. Needs direction().
struct Frame { vec3 tangent, normal; };
vec3 binormal(Frame f) { return cross(f.tangent, f.normal); }
vec3 inSpace(Frame f, vec3 o) { return o.x * f.normal + o.y * binormal(f) + o.z * f.tangent; }

vec3 mirrored(vec3 v, vec3 m) { return v - (2.0 * dot(m, v) / dot(m, m)) * m; }
Frame completed(vec3 tangent, vec3 near) { return Frame(tangent, normalize(near - dot(near, tangent) * tangent)); }

Frame turnedTo(Frame f, vec3 along) {
  vec3 tangent = direction(along), between = f.tangent + tangent;
  if (dot(between, between) < 1e-12) return completed(tangent, -f.normal);  // opposite, as well as floats can tell
  return completed(tangent, mirrored(mirrored(f.normal, f.tangent), between));
}

// Double reflection: over a step of the curve to where it has that tangent.
Frame transported(Frame f, vec3 step, vec3 tangent) {
  if (tangent == vec3(0)) return f;
  if (dot(step, step) == 0.0) return turnedTo(f, tangent);
  vec3 normal = mirrored(f.normal, step), second = tangent - mirrored(f.tangent, step);
  return completed(tangent, dot(second, second) > 0.0 ? mirrored(normal, second) : normal);
}
