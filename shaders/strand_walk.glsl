// Drawing strands without the graphics pipeline: one invocation a segment walks its pixels. A column of pixels (a row, for a
// steep segment) gets exactly the area that the ribbon has in it, each pixel its part: the ribbon's extent across the
// column and its slope within it are both boxes, so the parts are those of a trapezoid. Areas add up to length × width.
void put(ivec2 pixel, float area, float depth, float along);   // 0 < area <= 1; `along` from this point to the next

// The part of a trapezoid that lies before x: the convolution of boxes of widths h and m about 0.
float trapezoidBefore(float x, float h, float m) {
  vec4 r = max(vec4(x) + 0.5 * vec4(h + m, h - m, m - h, -h - m), 0.0);
  r *= r;
  return clamp((r.x - r.y - r.z + r.w) / (2.0 * h * m), 0.0, 1.0);
}

// Pixels of rows firstRow … endRow − 1 alone.
void walkSegment(uint point, int firstRow, int endRow) {
  if (strandPoints[point].seed != strandPoints[point + 1u].seed) return;  // the end of a strand
  vec4 a = clipFromWorld * vec4(strandPoints[point].positionWidth.xyz, 1);
  vec4 b = clipFromWorld * vec4(strandPoints[point + 1u].positionWidth.xyz, 1);
  float near = viewForward.w;
  if (!(a.w >= near || b.w >= near)) return;
  vec2 cut = vec2(a.w < near ? (near - a.w) / (b.w - a.w) : 0.0, b.w < near ? (near - a.w) / (b.w - a.w) : 1.0);
  vec4 from = mix(a, b, cut.x), to = mix(a, b, cut.y);
  vec2 widths = mix(vec2(strandPoints[point].positionWidth.w), vec2(strandPoints[point + 1u].positionWidth.w), cut) /
                (eye.w * vec2(from.w, to.w));
  vec2 pa = (0.5 * from.xy / from.w + 0.5) * viewport.xy, pb = (0.5 * to.xy / to.w + 0.5) * viewport.xy;
  vec2 d = pb - pa;
  bool steep = abs(d.y) > abs(d.x);
  vec2 lo = vec2(0.0, float(firstRow)), hi = vec2(viewport.x, float(endRow));
  if (steep) { pa = pa.yx; d = d.yx; lo = lo.yx; hi = hi.yx; }
  if (!(abs(d.x) > 1e-6)) return;
  float slope = d.y / d.x, stretch = sqrt(1.0 + slope * slope);
  float start = min(pa.x, pa.x + d.x), stop = max(pa.x, pa.x + d.x);
  int last = int(min(floor(stop), hi.x - 1.0));
  for (int column = int(max(floor(start), lo.x)); column <= last; ++column) {
    vec2 ends = vec2(max(start, float(column)), min(stop, float(column) + 1.0));
    float t = (0.5 * (ends.x + ends.y) - pa.x) / d.x, part = ends.y - ends.x;
    float middle = pa.y + t * d.y, tall = mix(widths.x, widths.y, t) * stretch;  // across the column
    if (!(tall > 0.0)) continue;
    // Boxes below a fiftieth of a pixel would lose their digits.
    float h = max(tall, 0.02), m = max(abs(slope) * part, 0.02), reach = 0.5 * (h + m);
    int row = int(max(floor(middle - reach), lo.y)), end = int(min(floor(middle + reach), hi.y - 1.0));
    float before = trapezoidBefore(float(row) - middle, h, m);
    for (; row <= end; ++row) {
      float after = trapezoidBefore(float(row) + 1.0 - middle, h, m);
      float area = min(part * tall * (after - before), 1.0);
      before = after;
      ivec2 pixel = ivec2(column, row);
      if (area > 0.0) put(steep ? pixel.yx : pixel, area, mix(from.w, to.w, t), mix(cut.x, cut.y, t));
    }
  }
}

// −log(1 − α): what overlapping hairs add up. All but a thousandth of a covered pixel.
float opticalDepthOf(float area) { return -log(1.0 - min(area, 0.999)); }
