// How one hair scatters light: the single function that the path tracer, dual scattering and the preview
// share.
//
// Frame of a fibre: x along it, root to tip. A direction of longitudinal inclination θ (from the normal
// plane, towards the tip) and azimuth φ is (sin θ, cos θ cos φ, cos θ sin φ). All directions point away from
// the fibre.
#pragma once

#include <array>
#include <memory>

#include "coif/base/vec.h"

namespace coif {

enum class FibreModel {
  KajiyaKay,  ///< Kajiya & Kay 1989
  Marschner,  ///< Marschner et al. 2003: R, TT, TRT, gaussian lobes of unit area over the outgoing
              ///< inclination
  Chiang,     ///< Chiang et al. 2016: R, TT, TRT and the rest, energy conserving (d'Eon 2011 M, logistic N)
};

/// Roughnesses are Chiang's perceptual ones in [0, 1]; the other models take the same standard deviations
/// from them. Values outside the stated ranges are clamped.
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

/// Tables are built once; all queries are const and thread-safe.
class FibreScattering {
 public:
  explicit FibreScattering(const FibreParameters& parameters);
  ~FibreScattering();
  FibreScattering(const FibreScattering&);
  FibreScattering& operator=(const FibreScattering&);

  const FibreParameters& parameters() const;

  /// f(ω_i, ω_o; h) · cos θ_i per steradian, for light that meets the fibre at offset h in [−1, 1] of its
  /// radius (the offset is that of the ray along ω_o, as a path tracer meets it). Never negative, never NaN.
  Vec3 evaluate(const Vec3& wi, const Vec3& wo, double h) const;
  /// Mean of the above over h: the far field.
  Vec3 evaluate(const Vec3& wi, const Vec3& wo) const;
  /// Draws ω_i for ω_o; `u` uniform in [0, 1)⁴.
  FibreSample sample(const Vec3& wo, double h, const std::array<double, 4>& u) const;
  double pdf(const Vec3& wi, const Vec3& wo, double h) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace coif
