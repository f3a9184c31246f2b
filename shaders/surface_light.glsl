// What reaches a surface through hair and past the head.
#define VISIBILITY_NONE
#include "visibility.glsl"
#ifdef SURFACE_SHADOW
layout(binding = 8) uniform sampler2D surfaceShadow;   // surface_shadow.comp
#endif
struct SurfaceLight {
  vec3 transmitted[3];   // of key, fill, rim
  vec3 sky;              // open part
};

float keyThroughHair(vec3 p) {
#if defined(SURFACE_SHADOW)
  vec2 at = mapProject(p).xy / mapInfo.x;
  return all(equal(at, clamp(at, vec2(0), vec2(1)))) ? texture(surfaceShadow, at).r : 1.0;
#elif defined(LIGHT_MAP)
  return keyTransmittance(keyTaps(p, vec2(0)), vec3(1)).x;
#else
  return 1.0;
#endif
}

// Each hair on the way stops what does not go on through it, as in strands (fibre_tables.glsl): T_f = T^(1 − ā_f).
vec3 withScattered(float transmitted) { return pow(vec3(max(transmitted, 1e-6)), 1.0 - hairPasses.rgb); }

SurfaceLight lightOn(vec3 p, vec3 n) {
  vec4 hair = volumeAt(p + n * volumeLo.w);
  // A surface r texels away is at most r sin θ texels, along its normal, nearer to the light.
  vec3 above = p + n * (2.5 * shadowInfo.z);
  return SurfaceLight(vec3[](keyPastHeadSmoothly(above) * withScattered(keyThroughHair(above)),
                             withScattered(exp(-0.8 * hair.y)), withScattered(exp(-0.8 * hair.z))),
                      withScattered(hair.w));
}
