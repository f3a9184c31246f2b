// The factors that fibre models are made of: longitudinal and azimuthal distributions, what is left of the
// light after crossing a fibre p times. d'Eon et al. 2011; Chiang et al. 2016.
#pragma once

#include <array>

#include "coif/base/vec.h"

namespace coif {

/// An inclination with its sine and cosine; cos >= 0.
struct Inclination {
  double angle = 0, sin = 0, cos = 1;
  static Inclination ofAngle(double angleRad);
  static Inclination ofSine(double sine);
};

/// log I₀(x), x >= 0: the power series up to 15, the asymptotic one beyond; relative error of I₀ below 1e-12.
double logBesselI0(double x);

/// d'Eon's M of variance v: ∫ M cos θ_i dθ_i = 1 for every θ_o; symmetric. In logarithms throughout, so that
/// 1 / sinh(1/v) neither overflows nor vanishes.
double longitudinalDensity(const Inclination& i, const Inclination& o, double variance);
/// Draws θ_i by `longitudinalDensity`, exactly.
Inclination sampleLongitudinal(const Inclination& o, double variance, double u1, double u2);

/// Logistic distribution of scale s, trimmed to [−π, π] and repeated with period 2π.
class TrimmedLogistic {
 public:
  explicit TrimmedLogistic(double scale);
  double density(double x) const;
  /// Grows by 1 a period; 0 at −π.
  double cumulative(double x) const;
  double sample(double u) const;
  /// Mean of density over [a, b] (in either order); the density itself where they meet.
  double meanDensity(double a, double b) const;

 private:
  double scale_, low_, mass_;
};

/// Light that meets a fibre at offset h: attenuation of R, TT, TRT and of all that is left (their sum is 1
/// without absorption), and where they leave.
struct Crossing {
  std::array<Vec3, 4> attenuation;
  double gamma = 0, gammaInside = 0;

  /// Azimuth of order p against the direction it came from: 2pγ_t − 2γ + pπ.
  double azimuth(int order) const;
};
/// `withLoss` false leaves the attenuations out.
Crossing crossFibre(const Inclination& at, double h, double index, const Vec3& absorption,
                    bool withLoss = true);

/// Reflectance of unpolarised light, `index` >= 1 inside.
double fresnel(double cosine, double index);

}  // namespace coif
