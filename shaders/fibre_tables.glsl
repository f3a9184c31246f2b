// One hair's scattering and the multiple scattering around it, from light's tables (include/coif/light/fibre.h,
// dual_scattering.h). GREY: red stands for all.
layout(std140, binding = 2) uniform Fibre {
  vec4 lobeShifts, lobeVariances;  // R, TT, TRT, rest, over θ_i + θ_o
  ivec4 fibreCounts;               // model; inclinations; inclinations of the azimuthal tables
  vec4 fibreDensities;             // d_f, d_b
};
const int kKajiyaKay = 0, kMarschner = 1, kChiang = 2;
layout(binding = 5) uniform sampler2DArray azimuthalTable;   // x: 0 … π, y: 0 … π/2; N of four lobes, then N^G
layout(binding = 6) uniform sampler2D inclinationTable;      // ā_f, β̄_f²; Ā_b, Δ̄_b, σ̄_b² over θ_diff; ā_b
const float kPi = 3.14159265, kHalfPi = 1.57079633;

vec3 overInclination(int row, float theta) {
  float n = float(fibreCounts.y);
  float x = ((theta / kPi + 0.5) * (n - 1.0) + 0.5) / n;
  return texture(inclinationTable, vec2(x, (float(row) + 0.5) / 6.0)).rgb;
}
vec3 overAzimuth(int layer, float inclination, float phi) {
  vec2 n = vec2(textureSize(azimuthalTable, 0).xy);
  vec2 at = (vec2(phi / kPi, inclination / kHalfPi) * (n - 1.0) + 0.5) / n;
  return texture(azimuthalTable, vec3(at, float(layer))).rgb;
}

// e^−x I₀(x)
float scaledBesselI0(float x) {
  if (x > 8.0) {
    float y = 1.0 / (8.0 * x);
    return (1.0 + y * (1.0 + 4.5 * y * (1.0 + 8.3333333 * y))) * inversesqrt(2.0 * kPi * x);
  }
  float q = 0.25 * x * x, sum = 1.0;
  for (int k = 12; k > 0; --k) sum = 1.0 + sum * q / float(k * k);
  return sum * exp(-x);
}
// d'Eon's M times cos θ_i. The exponentials are taken together: each alone would overflow for a smooth hair.
float longitudinalDensity(float thetaI, float thetaO, float variance) {
  if (abs(thetaO) > kHalfPi) thetaO = sign(thetaO) * kPi - thetaO;
  float s = sin(0.5 * (thetaI + thetaO));
  float fall = exp(-2.0 * s * s / variance) * scaledBesselI0(max(cos(thetaI) * cos(thetaO), 0.0) / variance);
  return fall / (variance * (1.0 - exp(-2.0 / variance)));
}
// cosⁿ x over its area on [−π/2, π/2], n = 1 / variance.
float cosinePower(float x, float n) {
  float area2 = kPi / (0.5 * n + 0.25 + 1.0 / (16.0 * n + 8.0));
  return pow(max(cos(x), 0.0), n) * inversesqrt(area2);
}
float longitudinal(int lobe, float thetaI, float thetaO, float extraVariance) {
  float variance = lobeVariances[lobe] + extraVariance, x = thetaI + thetaO - lobeShifts[lobe];
  if (fibreCounts.x == kChiang) return longitudinalDensity(thetaI, thetaO - lobeShifts[lobe], variance);
  if (lobe == 3) return fibreCounts.x == kKajiyaKay ? cos(thetaI) * 2.0 / kPi : 0.0;
  float cosine = max(cos(0.5 * (thetaO - thetaI)), 1e-3), cone = cos(thetaI) / (cosine * cosine);
  if (fibreCounts.x == kMarschner) return exp(-0.5 * x * x / variance) * inversesqrt(2.0 * kPi * variance) * cone;
  return lobe == 0 ? cosinePower(x, 1.0 / variance) * cone : 0.0;
}

// Directions at a hair of unit tangent t.
struct Bearings { float thetaI, thetaO, phi; };
Bearings bearingsOf(vec3 t, vec3 toLight, vec3 toEye) {
  float sinI = clamp(dot(t, toLight), -1.0, 1.0), sinO = clamp(dot(t, toEye), -1.0, 1.0);
  vec3 l = toLight - sinI * t, e = toEye - sinO * t;
  float cosPhi = clamp(dot(l, e) * inversesqrt(max(dot(l, l) * dot(e, e), 1e-20)), -1.0, 1.0);
  return Bearings(asin(sinI), asin(sinO), acos(cosPhi));
}

// f_s · cos θ_i of light spread by `variance` over inclination; `scattered`: over the front half in azimuth.
vec3 singleScattering(Bearings b, vec3 variance, bool scattered) {
  float at = abs(fibreCounts.x == kMarschner ? 0.5 * (b.thetaO - b.thetaI) : b.thetaO);
  vec3 sum = vec3(0);
  for (int lobe = 0; lobe < 4; ++lobe) {
    vec3 along = vec3(longitudinal(lobe, b.thetaI, b.thetaO, variance.r));
#ifndef GREY
    if (scattered) {
      along.g = longitudinal(lobe, b.thetaI, b.thetaO, variance.g);
      along.b = longitudinal(lobe, b.thetaI, b.thetaO, variance.b);
    }
#endif
    sum += along * overAzimuth(lobe + (scattered ? 4 : 0), at, b.phi);
  }
  return sum;
}

// Of even light from the eye's side: what one hair sends back, and what the hairs around it do.
vec3 evenAlbedo(float thetaO) {
#ifdef SHADING_DUAL
  return overInclination(5, thetaO) + fibreDensities.y * overInclination(2, thetaO);
#else
  return overInclination(5, thetaO);
#endif
}

// The sky's light past the hair over the open part that the volume holds: hair dims it by what fibres do not scatter on,
// 1 − ā_f, and the volume's part is right where that is a sixth (brown hair; docs/preview.md).
vec3 skyThroughHair(float open) {
#ifdef SHADING_DUAL
  return pow(vec3(max(open, 1e-4)), (1.0 - overInclination(0, 0.0)) * 1.2 - 1.0);
#else
  return vec3(1);
#endif
}

#ifdef SHADING_DUAL
// f_back · cos θ_i.
vec3 backScattering(Bearings b, vec3 variance, bool scattered) {
  float azimuthal = scattered ? (1.0 - b.phi / kPi) / kPi : (b.phi < kHalfPi ? 1.0 / kPi : 0.0);
  if (azimuthal == 0.0) return vec3(0);
  float theta = 0.5 * (b.thetaO - b.thetaI);
  vec3 shift = overInclination(3, theta), spread = overInclination(4, theta) + variance;
  vec3 along = vec3(longitudinalDensity(b.thetaI, b.thetaO - shift.r, spread.r));
#ifndef GREY
  along.g = longitudinalDensity(b.thetaI, b.thetaO - shift.g, spread.g);
  along.b = longitudinalDensity(b.thetaI, b.thetaO - shift.b, spread.b);
#endif
  return overInclination(2, theta) * along * azimuthal;
}

// The number of hairs on the way is Poisson's, of mean Ω (the taps'); each leaves ā_f: T_f = e^−Ω(1 − ā_f), of which
// e^−Ω met none, and hairs met by what got through number Ω ā_f / (1 − e^−Ω ā_f) on average.
vec3 reachedThrough(Bearings b, vec4 depths, vec4 weights) {
  vec3 left = min(overInclination(0, b.thetaI), vec3(1)), transmitted = vec3(0);
  float direct = dot(weights, exp(-depths)), depth = dot(weights, depths);
  for (int k = 0; k < 4; ++k) transmitted += weights[k] * exp(-depths[k] * (1.0 - left));
  vec3 out_ = direct * (singleScattering(b, vec3(0), false) + fibreDensities.y * backScattering(b, vec3(0), false));
  vec3 scattered = fibreDensities.x * max(transmitted - direct, vec3(0));
  if (max(scattered.r, max(scattered.g, scattered.b)) < 1e-5) return out_;
  vec3 met = depth * left;
  vec3 variance = overInclination(1, b.thetaI) * met / max(1.0 - exp(-met), vec3(1e-6));
  variance = clamp(variance, vec3(0), vec3(10));
  return out_ + scattered * (singleScattering(b, variance, true) + fibreDensities.y * backScattering(b, variance, true));
}
#else
vec3 reachedThrough(Bearings b, vec4 depths, vec4 weights) {
  return dot(weights, exp(-depths)) * singleScattering(b, vec3(0), false);
}
#endif
