#include "fibre_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "coif/light/hair_color.h"

namespace coif {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kStrips = 96;               // over the fibre's width, even in the angle of the normal
constexpr int kGainNodes = 129;           // crowded towards ±90°
constexpr double kSmallestCosine = 1e-3;  // 1 / cos² of the difference angle stays below 1e6

double within(double value, double low, double high) {
  return value >= low ? std::min(value, high) : low;
}

FibreParameters withinRanges(FibreParameters p) {
  for (int c = 0; c < 3; ++c) p.absorption[c] = within(p.absorption[c], 0, 1e30);
  p.index = within(p.index, 1, 3);
  p.longitudinalRoughness = within(p.longitudinalRoughness, 1e-3, 1);
  p.azimuthalRoughness = within(p.azimuthalRoughness, 1e-3, 1);
  p.tiltRad = within(p.tiltRad, -0.3, 0.3);
  return p;
}

double varianceOf(double beta) {
  const double deviation = 0.726 * beta + 0.812 * beta * beta + 3.7 * std::pow(beta, 20);
  return deviation * deviation;
}

double logisticScaleOf(double beta) {
  return std::sqrt(kPi / 8) * (0.265 * beta + 1.194 * beta * beta + 5.372 * std::pow(beta, 22));
}

double gaussian(double x, double variance) {
  return std::exp(-x * x / (2 * variance)) / std::sqrt(2 * kPi * variance);
}

double cosineLogArea(double n) {
  return 0.5 * std::log(kPi) + std::lgamma(n / 2 + 0.5) - std::lgamma(n / 2 + 1);
}

// cosⁿ x over its area on [−π/2, π/2].
double cosinePower(double x, double n, double logArea) {
  const double cosine = std::cos(x);
  return cosine > 0 ? std::exp(n * std::log(cosine) - logArea) : 0;
}

Inclination difference(const Inclination& i, const Inclination& o) {
  return Inclination::ofAngle((o.angle - i.angle) / 2);
}

// cos θ_i / cos² θ_diff: light of the specular cone, on the way to f · cos θ_i.
double coneFactor(const Inclination& i, const Inclination& o) {
  const double cosine = std::max(kSmallestCosine, difference(i, o).cos);
  return i.cos / (cosine * cosine);
}

double gainNode(int node) {
  return kPi / 2 * std::sin(kPi * (double(node) / (kGainNodes - 1) - 0.5));
}

// Offset h of the border after so many strips, and the share of the width of the strip before it.
double stripEdge(double strips) {
  return std::sin(kPi * (strips / kStrips - 0.5));
}
double stripShare(int strip) {
  return (stripEdge(strip) - stripEdge(strip - 1)) / 2;
}

}  // namespace

FibreModelTerms::FibreModelTerms(const FibreParameters& wanted)
    : parameters(withinRanges(wanted)), azimuthalRoughness(logisticScaleOf(parameters.azimuthalRoughness)) {
  const double v = varianceOf(parameters.longitudinalRoughness), tilt = parameters.tiltRad;
  variances = {v, v / 4, 4 * v, 4 * v};
  shifts = {-2 * tilt, tilt, 4 * tilt, 0};
  kajiyaKay.fill(Vec3::Zero());
  if (parameters.model == FibreModel::Marschner) shifts[2] = 3 * tilt;
  if (parameters.model == FibreModel::Marschner) limitGain();
  if (parameters.model != FibreModel::KajiyaKay) return;
  shifts.fill(0);
  variances = {v, v, v, 1e4};  // of the diffuse part's proposal: M is then even over the sphere
  cosineLogArea_ = cosineLogArea(1 / v);
  limitGain();
  const double specular = fresnel(1, parameters.index);
  kajiyaKay[0] = Vec3::Constant(specular);
  kajiyaKay[3] = (1 - specular) * albedoFromAbsorption(parameters.absorption, parameters.azimuthalRoughness);
}

Inclination FibreModelTerms::tilted(int lobe, const Inclination& o) const {
  return shifts[lobe] == 0 ? o : Inclination::ofAngle(o.angle - shifts[lobe]);
}

double FibreModelTerms::longitudinal(int lobe, const Inclination& i, const Inclination& o,
                                     double extraVariance) const {
  const double variance = variances[lobe] + extraVariance;
  if (parameters.model == FibreModel::Chiang) return longitudinalDensity(i, tilted(lobe, o), variance);
  if (lobe == 3) return parameters.model == FibreModel::KajiyaKay ? i.cos * 2 / kPi : 0;
  if (gainLimits_[lobe].empty()) return 0;
  return gaussianLobe(lobe, i, o, variance) * gainLimit(lobe, i.angle) * gainLimit(lobe, o.angle);
}

double FibreModelTerms::gaussianLobe(int lobe, const Inclination& i, const Inclination& o,
                                     double variance) const {
  const double sum = i.angle + o.angle - shifts[lobe];
  if (parameters.model == FibreModel::Marschner) return gaussian(sum, variance) * coneFactor(i, o);
  const double n = 1 / variance;
  const double logArea = variance == variances[lobe] ? cosineLogArea_ : cosineLogArea(n);
  return cosinePower(sum, n, logArea) * coneFactor(i, o);
}

void FibreModelTerms::limitGain() {
  const int lobes = parameters.model == FibreModel::Marschner ? 3 : 1;
  for (int p = 0; p < lobes; ++p) {
    const double reach = 6 * std::sqrt(variances[p]);
    std::vector<double> areas(kGainNodes);
    for (int node = 0; node < kGainNodes; ++node) {
      const Inclination o = Inclination::ofAngle(gainNode(node));
      const double middle = shifts[p] - o.angle;
      const double low = std::max(-kPi / 2, middle - reach), high = std::min(kPi / 2, middle + reach);
      constexpr int steps = 120;
      for (int s = 0; s < steps && high > low; ++s) {
        const Inclination i = Inclination::ofAngle(low + (high - low) * (s + 0.5) / steps);
        areas[node] += gaussianLobe(p, i, o, variances[p]) * i.cos * (high - low) / steps;
      }
    }
    gainLimits_[p].resize(kGainNodes);
    for (int node = 0; node < kGainNodes; ++node) {  // of the neighbours too: between nodes it holds as well
      const double most =
          std::max({areas[std::max(0, node - 1)], areas[node], areas[std::min(kGainNodes - 1, node + 1)]});
      gainLimits_[p][node] = 1 / std::max(1.0, most);
    }
  }
}

double FibreModelTerms::gainLimit(int lobe, double theta) const {
  const double u = std::asin(std::clamp(theta / (kPi / 2), -1.0, 1.0)) / kPi + 0.5;
  const double x = u * (kGainNodes - 1);
  const int low = std::min(int(x), kGainNodes - 2);
  return gainLimits_[lobe][low] + (x - low) * (gainLimits_[lobe][low + 1] - gainLimits_[lobe][low]);
}

Crossing FibreModelTerms::cross(const Inclination& i, const Inclination& o, double h) const {
  if (parameters.model == FibreModel::KajiyaKay) return {kajiyaKay, 0, 0};
  return crossFibre(crossedAt(i, o), h, parameters.index, parameters.absorption);
}

Inclination FibreModelTerms::crossedAt(const Inclination& i, const Inclination& o) const {
  return parameters.model == FibreModel::Chiang ? o : difference(i, o);
}

double FibreModelTerms::azimuth(int lobe, const Crossing& crossing, double phi) const {
  if (isotropic(lobe)) return 1 / (2 * kPi);
  return azimuthalRoughness.density(phi - crossing.azimuth(lobe));
}

void FibreModelTerms::meanAzimuths(const Inclination& i, const Inclination& o, std::span<const double> phis,
                                   std::span<std::array<Vec3, 4>> out) const {
  if (parameters.model == FibreModel::KajiyaKay) {
    std::array<Vec3, 4> even = kajiyaKay;
    for (Vec3& value : even) value /= 2 * kPi;
    std::fill(out.begin(), out.end(), even);
    return;
  }
  const Inclination at = crossedAt(i, o);
  for (auto& sum : out) sum.fill(Vec3::Zero());
  Crossing low = crossFibre(at, -1, parameters.index, parameters.absorption, false);
  for (int strip = 1; strip <= kStrips; ++strip) {
    const Crossing middle = crossFibre(at, stripEdge(strip - 0.5), parameters.index, parameters.absorption);
    const Crossing high = crossFibre(at, stripEdge(strip), parameters.index, parameters.absorption, false);
    const double share = stripShare(strip);
    for (std::size_t k = 0; k < phis.size(); ++k) {
      for (int p = 0; p < 3; ++p) {
        out[k][p] +=
            middle.attenuation[p] *
            (share * azimuthalRoughness.meanDensity(phis[k] - low.azimuth(p), phis[k] - high.azimuth(p)));
      }
      out[k][3] += middle.attenuation[3] * (share / (2 * kPi));
    }
    low = high;
  }
}

std::array<Vec3, 4> FibreModelTerms::meanAttenuation(const Inclination& i, const Inclination& o) const {
  if (parameters.model == FibreModel::KajiyaKay) return kajiyaKay;
  std::array<Vec3, 4> sum;
  sum.fill(Vec3::Zero());
  for (int strip = 1; strip <= kStrips; ++strip) {
    const Crossing middle = cross(i, o, stripEdge(strip - 0.5));
    for (int p = 0; p < 4; ++p) sum[p] += middle.attenuation[p] * stripShare(strip);
  }
  return sum;
}

FibreModelTerms::Both FibreModelTerms::both(const Inclination& i, const Inclination& o,
                                            const Crossing& crossing, const std::array<double, 4>& chances,
                                            double phi) const {
  Both out;
  const bool same = parameters.model == FibreModel::Chiang;  // it is drawn from its own M
  for (int p = 0; p < 4; ++p) {
    const double around = azimuth(p, crossing, phi);
    const double drawn = chances[p] > 0 || same ? proposal(p, i, o) : 0;
    out.value += crossing.attenuation[p] * (around * (same ? drawn : longitudinal(p, i, o, 0)));
    out.pdf += chances[p] * drawn * around;
  }
  return out;
}

std::array<double, 4> FibreModelTerms::chances(const Inclination& o, double h) const {
  // Light on the specular cone has θ_i = −θ_o, for which the difference angle is θ_o itself.
  const Crossing crossing = cross(Inclination{-o.angle, -o.sin, o.cos}, o, h);
  std::array<double, 4> out;
  double sum = 0;
  const int lobes = parameters.model == FibreModel::Marschner ? 3 : 4;
  for (int p = 0; p < 4; ++p) sum += out[p] = p < lobes ? crossing.attenuation[p].sum() : 0;
  if (!(sum > 1e-300)) return {1, 0, 0, 0};  // all is absorbed: any direction will do
  for (double& chance : out) chance /= sum;
  return out;
}

double FibreModelTerms::proposal(int lobe, const Inclination& i, const Inclination& o) const {
  return longitudinalDensity(i, tilted(lobe, o), variances[lobe]);
}

Inclination FibreModelTerms::sampleInclination(int lobe, const Inclination& o, double u1, double u2) const {
  return sampleLongitudinal(tilted(lobe, o), variances[lobe], u1, u2);
}

double FibreModelTerms::sampleAzimuth(int lobe, const Crossing& crossing, double u) const {
  if (isotropic(lobe)) return 2 * kPi * u;
  return crossing.azimuth(lobe) + azimuthalRoughness.sample(u);
}

}  // namespace coif
