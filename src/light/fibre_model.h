// One fibre model: the factors of its lobes, and the proposals by which they are sampled.
#pragma once

#include <span>
#include <vector>

#include "coif/light/fibre.h"
#include "fibre_terms.h"

namespace coif {

/// Lobes are numbered as in FibreLobe. The scattering function is
/// Σ longitudinal(p) · attenuation[p] · azimuth(p); drawn from Σ chances[p] · proposal(p) · azimuth(p).
struct FibreModelTerms {
  FibreParameters parameters;       ///< within their ranges
  std::array<double, 4> variances;  ///< over θ_i + θ_o
  std::array<double, 4> shifts;     ///< of θ_i + θ_o
  TrimmedLogistic azimuthalRoughness;
  std::array<Vec3, 4> kajiyaKay;  ///< what its lobes leave of the light

  explicit FibreModelTerms(const FibreParameters& wanted);

  double longitudinal(int lobe, const Inclination& i, const Inclination& o, double extraVariance) const;
  /// Attenuation and azimuths at offset h: of θ_o (Chiang), of the difference angle (Marschner).
  Crossing cross(const Inclination& i, const Inclination& o, double h) const;
  /// Density over φ = φ_i − φ_o.
  double azimuth(int lobe, const Crossing& crossing, double phi) const;
  /// ∫ attenuation · azimuth dh / 2 of every lobe, at these azimuths.
  void meanAzimuths(const Inclination& i, const Inclination& o, std::span<const double> phis,
                    std::span<std::array<Vec3, 4>> out) const;
  /// ∫ attenuation dh / 2.
  std::array<Vec3, 4> meanAttenuation(const Inclination& i, const Inclination& o) const;

  /// f · cos θ_i and the density of its proposals, together.
  struct Both {
    Vec3 value = Vec3::Zero();
    double pdf = 0;
  };
  Both both(const Inclination& i, const Inclination& o, const Crossing& crossing,
            const std::array<double, 4>& chances, double phi) const;
  std::array<double, 4> chances(const Inclination& o, double h) const;
  double proposal(int lobe, const Inclination& i, const Inclination& o) const;
  Inclination sampleInclination(int lobe, const Inclination& o, double u1, double u2) const;
  double sampleAzimuth(int lobe, const Crossing& crossing, double u) const;

 private:
  bool isotropic(int lobe) const { return lobe == 3 || parameters.model == FibreModel::KajiyaKay; }
  Inclination crossedAt(const Inclination& i, const Inclination& o) const;
  Inclination tilted(int lobe, const Inclination& o) const;
  double gaussianLobe(int lobe, const Inclination& i, const Inclination& o, double variance) const;
  void limitGain();
  double gainLimit(int lobe, double theta) const;

  // A gaussian in inclination gains light at grazing angles, up to four times. What each side is multiplied
  // by so that no lobe does; the same for both sides, so reciprocity stays. Empty: Chiang.
  std::array<std::vector<double>, 3> gainLimits_;
  double cosineLogArea_ = 0;  // of Kajiya–Kay's exponent
};

}  // namespace coif
