// Integrals over the sphere, fine enough for a fibre's roughness.
#pragma once

#include <cmath>
#include <functional>
#include <numbers>

#include "coif/light/fibre.h"

namespace coif {

inline Vec3 direction(double theta, double phi) {
  return Vec3(std::sin(theta), std::cos(theta) * std::cos(phi), std::cos(theta) * std::sin(phi));
}

/// Midpoint rule over θ and φ. The steps are a third of the narrowest lobe's deviation and half the
/// logistic's scale: for functions that decay like these the rule's error is then below 1e-5.
inline Vec3 overSphere(const FibreScattering& fibre, const std::function<Vec3(const Vec3&)>& f) {
  const double pi = std::numbers::pi, beta = fibre.parameters().azimuthalRoughness;
  const double deviation = std::sqrt(fibre.lobeVariance(FibreLobe::TT));
  const double scale = 0.6267 * (0.265 * beta + 1.194 * beta * beta);
  const int thetas = std::max(90, int(std::ceil(3 * pi / deviation)));
  const int phis = std::max(64, int(std::ceil(4 * pi / scale)));
  Vec3 sum = Vec3::Zero();
  for (int t = 0; t < thetas; ++t) {
    const double theta = pi * ((t + 0.5) / thetas - 0.5);
    Vec3 ring = Vec3::Zero();
    for (int p = 0; p < phis; ++p) ring += f(direction(theta, 2 * pi * (p + 0.5) / phis));
    sum += ring * std::cos(theta);
  }
  return sum * (pi / thetas) * (2 * pi / phis);
}

inline double radians(double degrees) {
  return degrees * std::numbers::pi / 180;
}

}  // namespace coif
