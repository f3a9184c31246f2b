// How one hair scatters light: the single function that the path tracer, dual scattering and the preview
// share.
//
// Frame of a fibre: x along it, root to tip. A direction of longitudinal inclination θ (from the normal
// plane, towards the tip) and azimuth φ is (sin θ, cos θ cos φ, cos θ sin φ). All directions point away from
// the fibre.
//
// Highlights: scales lean away from the root, their normals towards it by α, so R is seen where
// θ_i + θ_o = −2α, TT at +α, TRT at +4α (Chiang) or +3α (Marschner).
// Roughness: β_m gives the variance v of R over θ_i + θ_o, v/4 of TT, 4v of TRT; β_n the scale s of a
// logistic distribution over azimuth (Chiang et al. 2016, (7) and (8)).
// Energy: Chiang conserves it exactly (∫ f cos θ_i dω_i = 1 without absorption, at every h). Marschner and
// Kajiya–Kay are reciprocal, f(ω_i, ω_o) = f(ω_o, ω_i), in the far field; Chiang is not: its tilts and its
// attenuation are those of ω_o alone. Where a gaussian in inclination would gain light, near grazing, the other
// two are held so that no lobe does, symmetrically.
// Accuracy: the far field is a sum over 96 strips of the fibre with the azimuthal distribution integrated
// exactly along each, so caustics stay finite at any roughness; its integrals over azimuth are exact to 1e-4.
// Cost: about half a microsecond at a given h, twenty for the far field.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "coif/base/vec.h"

namespace coif {

enum class FibreModel {
  KajiyaKay,  ///< Kajiya & Kay 1989
  Marschner,  ///< Marschner et al. 2003: R, TT, TRT, gaussian lobes of unit area over the outgoing
              ///< inclination
  Chiang,     ///< Chiang et al. 2016: R, TT, TRT and the rest, energy conserving (d'Eon 2011 M, logistic N)
};

/// Roughnesses are Chiang's perceptual ones in [0, 1]; the other models take the same standard deviations
/// from them. Values outside the stated ranges are clamped, roughness below 1e-3 is 1e-3, a NaN is the
/// range's lower end.
struct FibreParameters {
  FibreModel model = FibreModel::Chiang;
  Vec3 absorption = Vec3(0.06, 0.10, 0.20);  ///< σ_a in 1 / fibre radius, >= 0, linear RGB
  double index = 1.55;                       ///< of refraction, 1 … 3
  double longitudinalRoughness = 0.3;        ///< β_m
  double azimuthalRoughness = 0.3;           ///< β_n
  double tiltRad = 0.0349;                   ///< of the cuticle scales towards the root (α), ± 0.3
};

struct FibreSample {
  Vec3 direction = Vec3::UnitY();  ///< ω_i
  Vec3 weight = Vec3::Zero();      ///< f · cos θ_i / pdf; zero: absorbed
  double pdf = 0;                  ///< per solid angle
};

/// What leaves a fibre, by the number of times it crossed it. Kajiya–Kay: its specular part is R, its diffuse
/// part Rest.
enum class FibreLobe { R, TT, TRT, Rest };
inline constexpr std::array<FibreLobe, 4> kFibreLobes{FibreLobe::R, FibreLobe::TT, FibreLobe::TRT,
                                                      FibreLobe::Rest};

/// Tables are built once; all queries are const and thread-safe.
class FibreScattering {
 public:
  explicit FibreScattering(const FibreParameters& parameters);
  ~FibreScattering();
  FibreScattering(const FibreScattering&);
  FibreScattering& operator=(const FibreScattering&);

  const FibreParameters& parameters() const;

  /// f(ω_i, ω_o; h) · cos θ_i per steradian, for light that meets the fibre at offset h in [−1, 1] of its
  /// radius (the offset is that of the ray along ω_o, as a path tracer meets it). With e the unit vector of
  /// ω_o in the normal plane, the ray meets the surface at radius · (√(1 − h²) e + h (e × x)), so
  /// h = sin(φ_o − φ_normal). Never negative, never NaN.
  Vec3 evaluate(const Vec3& wi, const Vec3& wo, double h) const;
  /// Mean of the above over h: the far field.
  Vec3 evaluate(const Vec3& wi, const Vec3& wo) const;
  /// Draws ω_i for ω_o; `u` uniform in [0, 1)⁴.
  FibreSample sample(const Vec3& wo, double h, const std::array<double, 4>& u) const;
  double pdf(const Vec3& wi, const Vec3& wo, double h) const;

  /// The far field in factors: evaluate(ω_i, ω_o) = Σ longitudinal · azimuthal(φ_i − φ_o) over the lobes.
  /// `extraVariance` widens the lobe, as light that arrives spread over inclination does.
  double longitudinal(FibreLobe lobe, double thetaI, double thetaO, double extraVariance = 0) const;
  Vec3 azimuthal(FibreLobe lobe, double thetaI, double thetaO, double phi) const;
  /// All four lobes at once, for the price of one.
  std::array<Vec3, 4> azimuthal(double thetaI, double thetaO, double phi) const;
  /// At many azimuths: much less than one by one.
  std::vector<std::array<Vec3, 4>> azimuthal(double thetaI, double thetaO,
                                             std::span<const double> phis) const;
  /// ∫ azimuthal dφ of the lobes: their sum is 1 without absorption.
  std::array<Vec3, 4> attenuation(double thetaI, double thetaO) const;
  /// The one inclination, >= 0, that azimuthal() and attenuation() depend on: tables need no other.
  double azimuthalInclination(double thetaI, double thetaO) const;
  /// θ_i + θ_o at which a lobe is seen, and its variance over that sum.
  double lobeShift(FibreLobe lobe) const;
  double lobeVariance(FibreLobe lobe) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace coif
