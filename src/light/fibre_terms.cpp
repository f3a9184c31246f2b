#include "fibre_terms.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace coif {
namespace {

constexpr double kPi = std::numbers::pi;

double logistic(double x, double scale) {
  return 1 / (1 + std::exp(-x / scale));
}

// Into [−π, π).
double wrap(double x) {
  return x - 2 * kPi * std::floor((x + kPi) / (2 * kPi));
}

double safeRoot(double x) {
  return std::sqrt(std::max(0.0, x));
}

}  // namespace

Inclination Inclination::ofAngle(double angleRad) {
  return {angleRad, std::sin(angleRad), std::abs(std::cos(angleRad))};
}

Inclination Inclination::ofSine(double sine) {
  sine = std::clamp(sine, -1.0, 1.0);
  return {std::asin(sine), sine, safeRoot(1 - sine * sine)};
}

double logBesselI0(double x) {
  if (x <= 15) {
    double term = 1, sum = 1;
    const double quarter = x * x / 4;
    for (int k = 1; k < 60 && term > 1e-14 * sum; ++k) sum += term *= quarter / (k * k);
    return std::log(sum);
  }
  double term = 1, sum = 1;
  for (int k = 1; k <= 12; ++k) sum += term *= (2 * k - 1) * (2 * k - 1) / (8 * x * k);
  return x - 0.5 * std::log(2 * kPi * x) + std::log(sum);
}

double longitudinalDensity(const Inclination& i, const Inclination& o, double variance) {
  const double a = i.cos * o.cos / variance, b = i.sin * o.sin / variance;
  // 1 / (2 v sinh(1/v)) = e^(−1/v) / (v (1 − e^(−2/v)))
  const double logScale = -1 / variance - std::log(variance * -std::expm1(-2 / variance));
  return std::exp(logBesselI0(a) - b + logScale);
}

Inclination sampleLongitudinal(const Inclination& o, double variance, double u1, double u2) {
  // fall = 1 − cos of the angle to the mirror direction
  const double fall = std::clamp(-variance * std::log(u1 + (1 - u1) * std::exp(-2 / variance)), 0.0, 2.0);
  const double cosine = 1 - fall, sine = safeRoot(fall * (2 - fall));
  return Inclination::ofSine(-cosine * o.sin + sine * std::cos(2 * kPi * u2) * o.cos);
}

TrimmedLogistic::TrimmedLogistic(double scale)
    : scale_(scale), low_(logistic(-kPi, scale)), mass_(logistic(kPi, scale) - low_) {}

double TrimmedLogistic::density(double x) const {
  const double e = std::exp(-std::abs(wrap(x)) / scale_);
  return e / (scale_ * (1 + e) * (1 + e) * mass_);
}

double TrimmedLogistic::cumulative(double x) const {
  const double turns = std::floor((x + kPi) / (2 * kPi));
  return turns + (logistic(x - 2 * kPi * turns, scale_) - low_) / mass_;
}

double TrimmedLogistic::sample(double u) const {
  const double x = -scale_ * std::log(1 / (u * mass_ + low_) - 1);
  return std::clamp(x, -kPi, kPi);
}

double TrimmedLogistic::meanDensity(double a, double b) const {
  // Below, the quotient of differences loses more digits than the midpoint rule.
  if (std::abs(b - a) < 1e-4 * std::min(1.0, scale_)) return density((a + b) / 2);
  return std::max(0.0, (cumulative(b) - cumulative(a)) / (b - a));
}

double fresnel(double cosine, double index) {
  const double inside = safeRoot(1 - (1 - cosine * cosine) / (index * index));
  if (!(cosine > 0)) return index > 1 ? 1 : 0;
  const double parallel = (index * cosine - inside) / (index * cosine + inside);
  const double perpendicular = (cosine - index * inside) / (cosine + index * inside);
  return (parallel * parallel + perpendicular * perpendicular) / 2;
}

double Crossing::azimuth(int order) const {
  return 2 * order * gammaInside - 2 * gamma + order * kPi;
}

Crossing crossFibre(const Inclination& at, double h, double index, const Vec3& absorption, bool withLoss) {
  h = std::clamp(h, -1.0, 1.0);
  const double insideCos = std::max(1e-6, safeRoot(1 - at.sin * at.sin / (index * index)));
  // h / η', η' = √(η² − sin² θ) / cos θ
  const double sinGamma = std::clamp(h * at.cos / std::max(1e-9, index * insideCos), -1.0, 1.0);
  Crossing out;
  out.gamma = std::asin(h);
  out.gammaInside = std::asin(sinGamma);
  if (!withLoss) return out;
  const double length = 2 * safeRoot(1 - sinGamma * sinGamma) / insideCos;
  const double reflected = fresnel(at.cos * safeRoot(1 - h * h), index);
  const double entering = 1 - reflected;
  for (int c = 0; c < 3; ++c) {
    const double left = std::exp(-absorption[c] * length);
    const double once = entering * entering * left, again = left * reflected;
    out.attenuation[0][c] = reflected;
    out.attenuation[1][c] = once;
    out.attenuation[2][c] = once * again;
    out.attenuation[3][c] = once > 0 ? once * again * again / (1 - again) : 0;
  }
  return out;
}

}  // namespace coif
