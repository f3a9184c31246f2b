// Dual scattering (Zinke, Yuksel, Weber & Keyser 2008): multiple scattering in hair from what lies between a
// point and the light (global: forward scattering) and from its neighbourhood (local: back-scattering).
//
// Frame, directions: those of a fibre (fibre.h). Colours linear RGB. Angles in radians.
// Formulas: `Printed` takes (14), (16), (17) and the factor 2 of (10) as the paper has them; `Corrected` sums
// all odd orders of back-scattering in closed form, takes shift and variance from the mean numbers of
// scatterings of the same sum, averages variances instead of deviations, keeps the energy of f_back at Ā_b,
// and spreads it by d'Eon's M, which needs no floor at grazing angles. docs/light.md says how each was
// decided. Accuracy: tables over 65 inclinations and 91 azimuths, linearly interpolated; azimuthal detail
// below two degrees is blurred, its energy kept. Cost: building about 50 ms; a call about two microseconds.
// const queries are thread-safe.
#pragma once

#include <numbers>
#include <optional>
#include <vector>

#include "coif/light/fibre.h"

namespace coif {

enum class DualFormulas { Printed, Corrected };

struct DualScatteringParameters {
  DualFormulas formulas = DualFormulas::Corrected;
  /// d_f and d_b: the share of directions around a point that hold hair, in [0, 1]. The paper's 0.7 belongs
  /// to its factor of 2; with the corrected formulas 1 is nearest to the path tracer (docs/light.md).
  double forwardDensity = 1, backwardDensity = 1;
};

/// (10) as printed; 1 is what conserves energy (ā_b + Ā_b = 1 without absorption).
inline constexpr double kPrintedBackscatterFactor = 2;

/// What reaches a point from one light through the hair: of unit irradiance, `directFraction` unscattered,
/// transmittance − directFraction after forward scattering, spread over inclination by `variance`.
struct ForwardScattering {
  double directFraction = 1;
  Vec3 transmittance = Vec3::Ones();  ///< T_f, without the density factor
  Vec3 variance = Vec3::Zero();       ///< σ̄_f² of the scattered part
};

/// Repeated back-scattering from a cluster of parallel fibres. (11) … (17)
struct Backscatter {
  double attenuation = 0;  ///< Ā_b: the first back-scattering excluded
  double shift = 0;        ///< Δ̄_b of θ_i + θ_o
  double variance = 0;     ///< σ̄_b²
};
/// One fibre's mean attenuation, shift and variance, forwards and backwards.
struct FibreMeans {
  double attenuationForward = 0, attenuationBackward = 0;
  double shiftForward = 0, shiftBackward = 0;
  double varianceForward = 0, varianceBackward = 0;
};
/// Attenuations are held at a sum <= 1; a lossless cluster's shift and variance, infinite, at 0.5 and 10.
Backscatter backscatterOf(const FibreMeans& fibre, DualFormulas formulas);
/// Ā_b of a fibre with `behind` others behind it instead of endlessly many: 0 with none, the corrected
/// attenuation in the limit. A pile of plates (Stokes 1862), all orders, `behind` >= 0.
double backscatterOfPile(double attenuationForward, double attenuationBackward, double behind);

/// What reaches a fibre when the hair around it is met by rays instead of supposed everywhere: in the place
/// of the density factors, which stay at 1 then. Directions as fibre.h has them, towards where the light
/// comes from.
struct SurroundingLight {
  /// The light that a fibre in front scatters on, as if the half cone of the light were as bright all around;
  /// nothing where there is none. One a ray; their mean is what arrives.
  struct Arrival {
    Vec3 direction = Vec3::UnitY();
    Vec3 transmittance = Vec3::Zero(), variance = Vec3::Zero();
  };
  double directFraction = 1;
  std::vector<Arrival> arrivals;
  /// What reaches the fibres behind that return light to this one, a mean; and the share of Ā_b that as many
  /// of them return.
  ForwardScattering behind{0, Vec3::Zero(), Vec3::Zero()};
  Vec3 backscatter = Vec3::Ones();
};

/// Of unscattered light that reaches a point, over what reaches the next fibre behind it: in hair at random
/// the way to that is exponential, its azimuth even over half the circle, and the mean of 1 / (1 + cos φ) is
/// 2/π.
inline constexpr double kReachesOverBehind = std::numbers::pi / 2;

/// Everything as plain arrays, for shaders: texels of three floats (RGB).
struct DualScatteringTables {
  int inclinations = 0;                                    ///< nodes, even from −π/2 to π/2
  std::vector<float> forwardAttenuation, forwardVariance;  ///< ā_f, β̄_f²
  std::vector<float> backwardAttenuation;                  ///< ā_b
  std::vector<float> backscatterAttenuation, backscatterShift, backscatterVariance;  ///< over θ_diff
  int azimuthInclinations = 0;  ///< nodes, even from 0 to π/2, of FibreScattering::azimuthalInclination
  int azimuths = 0;             ///< nodes, even from 0 to π, of |φ_i − φ_o|
  /// N and N^G: lobe (4) × inclination × azimuth × RGB.
  std::vector<float> azimuthal, azimuthalScattered;
};

class DualScattering {
 public:
  explicit DualScattering(const FibreScattering& fibre, const DualScatteringParameters& parameters = {});

  const FibreScattering& fibre() const { return fibre_; }
  const DualScatteringParameters& parameters() const { return parameters_; }
  const DualScatteringTables& tables() const { return tables_; }
  /// Of one channel, by quadrature: (6), (12).
  FibreMeans means(double theta, int channel) const;

  /// ā_f and β̄_f² of light that meets a fibre at this inclination.
  Vec3 forwardAttenuation(double theta) const;
  Vec3 forwardVariance(double theta) const;

  /// F of (21): radiance towards `wo` for unit irradiance from the light at `wi`.
  Vec3 evaluate(const Vec3& wi, const Vec3& wo, const ForwardScattering& arriving) const;
  /// With light that arrives unscattered as it leaves at offset h of the fibre (fibre.h): near field.
  Vec3 evaluate(const Vec3& wi, const Vec3& wo, const ForwardScattering& arriving, double h) const;
  /// The same with the surroundings' light, each arrival scattered from where it comes.
  Vec3 evaluate(const Vec3& wi, const Vec3& wo, const SurroundingLight& arriving, double h) const;
  /// What a fibre sends towards `wo` of what arrives, as if it went evenly over half the circle: ā_f on
  /// average.
  Vec3 turned(const Vec3& wi, const Vec3& wo, const ForwardScattering& arriving) const;
  /// Share of Ā_b that `behind` fibres give, light at this inclination.
  Vec3 backscatterShare(double theta, double behind) const;
  /// Its parts: f_s · cos θ_i of light spread by `variance` (N^G if `scattered`), f_back · cos θ_i.
  Vec3 single(const Vec3& wi, const Vec3& wo, const Vec3& variance, bool scattered) const;
  Vec3 back(const Vec3& wi, const Vec3& wo, const Vec3& variance, bool scattered) const;

 private:
  Vec3 shade(const Vec3& wi, const Vec3& wo, const ForwardScattering& arriving,
             std::optional<double> h) const;

  FibreScattering fibre_;
  DualScatteringParameters parameters_;
  DualScatteringTables tables_;
};

/// The path from a light to a point, fibre by fibre: log T_f and σ̄_f² add up. (5), (8)
class ForwardPath {
 public:
  /// A fibre met at inclination `theta`, `count` times (may be fractional).
  void cross(const DualScattering& hair, double theta, double count = 1);
  bool blocked() const { return blocked_; }
  ForwardScattering result() const;

 private:
  bool blocked_ = false;
  Vec3 logTransmittance_ = Vec3::Zero(), variance_ = Vec3::Zero();
};

}  // namespace coif
