// Light scattered by a hair: Kajiya & Kay 1989 for the diffuse part; three lobes along the fibre after
// Marschner et al. 2003 (reflection, transmission, inner reflection) with gaussian widths. The full model is `light`'s.
float lobe(float x, float width) { return exp(-0.5 * x * x / (width * width)) / (width * 2.5066283); }

vec3 scatter(vec3 t, vec3 toLight, vec3 toEye, vec3 c, float shift) {
  float sinI = clamp(dot(t, toLight), -1.0, 1.0), sinR = clamp(dot(t, toEye), -1.0, 1.0);
  float thetaI = asin(sinI), thetaR = asin(sinR);
  float cosI = sqrt(max(1.0 - sinI * sinI, 0.0));
  float half_ = 0.5 * (thetaI + thetaR), cosD = max(cos(0.5 * (thetaR - thetaI)), 0.2);
  vec3 l = toLight - sinI * t, e = toEye - sinR * t;
  float cosPhi = clamp(dot(l, e) * inversesqrt(max(dot(l, l) * dot(e, e), 1e-12)), -1.0, 1.0);
  float cosHalf = sqrt(0.5 + 0.5 * cosPhi);
  const float kDegree = 0.01745329;
  float mR = lobe(half_ + 7.0 * kDegree + shift, 6.0 * kDegree);
  float mTT = lobe(half_ - 3.5 * kDegree + shift, 6.0 * kDegree);
  float mTRT = lobe(half_ - 10.0 * kDegree + shift, 11.0 * kDegree);
  vec3 absorbed = pow(c, vec3(0.45));
  float nR = 0.17 * cosHalf * (0.06 + 0.94 * pow(1.0 - cosD * cosHalf, 5.0));
  float nTT = 0.6 * exp(-9.0 * (1.0 + cosPhi));
  float nTRT = 0.24 * (0.4 + 0.6 * max(cosPhi, 0.0));
  vec3 specular = (mR * nR + mTT * nTT * absorbed + mTRT * nTRT * absorbed * absorbed) / (cosD * cosD) * cosI;
  vec3 diffuse = c * (0.38 * cosI) * (0.5 + 0.5 * cosPhi);
  return specular + diffuse;
}
