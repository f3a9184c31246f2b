// What reaches a surface through hair and past the head.
#include "random.glsl"
#include "visibility.glsl"
struct SurfaceLight {
  vec3 transmitted;   // of key, fill, rim
  float sky;          // open part
};

SurfaceLight lightOn(vec3 p, vec3 n) {
  float u = 6.2831853 * random3(uint(gl_FragCoord.x), uint(gl_FragCoord.y), uint(viewport.z));
  vec4 hair = volumeAt(p + n * volumeLo.w);
  // A surface r texels away is at most r sin θ texels, along its normal, nearer to the light.
  vec3 above = p + n * (2.5 * shadowInfo.z);
  float key = 0.0;
  int lookUps = int(headColor.w);   // of four places, which the sub-frames share
  for (int k = 0; k < lookUps; ++k) {
    float place = float((int(viewport.z) * lookUps + k) & 3), a = u + 1.5707963 * place;
    vec2 offset = 0.5 * (1.0 + place) * vec2(cos(a), sin(a));
    key += 1.0 / float(lookUps) * keyPastHead(above, offset, 0.0) * keyTransmittance(keyTaps(above, offset), vec3(1)).x;
  }
  return SurfaceLight(vec3(key, exp(-0.8 * hair.y), exp(-0.8 * hair.z)), hair.w);
}
