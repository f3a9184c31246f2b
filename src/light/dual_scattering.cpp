#include "coif/light/dual_scattering.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "dual_tables.h"
#include "fibre_terms.h"

namespace coif {
namespace {

constexpr double kPi = std::numbers::pi;

double azimuthBetween(const Vec3& a, const Vec3& b) {
  return std::atan2(a.z(), a.y()) - std::atan2(b.z(), b.y());
}

double inclinationOf(const Vec3& w) {
  return std::asin(std::clamp(w.x(), -1.0, 1.0));
}

// s̃_b: 1/π backwards, nothing forwards; of light that comes evenly from the front half, its mean.
double backwardAzimuth(double phi, bool scattered) {
  const double turn = std::abs(phi - 2 * kPi * std::round(phi / (2 * kPi)));
  if (scattered) return (1 - turn / kPi) / kPi;
  return turn < kPi / 2 ? 1 / kPi : 0;
}

// f_back's longitudinal factor times cos θ_i.
double printedSpread(double thetaI, double thetaO, const Backscatter& back, double variance) {
  const double x = thetaI + thetaO - back.shift, v = back.variance + variance;
  const double cosine = std::max(1e-3, std::cos((thetaO - thetaI) / 2));
  return std::exp(-x * x / (2 * v)) / std::sqrt(2 * kPi * v) / (cosine * cosine) * std::cos(thetaI);
}

double correctedSpread(double thetaI, double thetaO, const Backscatter& back, double variance) {
  return longitudinalDensity(Inclination::ofAngle(thetaI), Inclination::ofAngle(thetaO - back.shift),
                             back.variance + variance);
}

}  // namespace

DualScattering::DualScattering(const FibreScattering& fibre, const DualScatteringParameters& parameters)
    : fibre_(fibre), parameters_(parameters), tables_(buildDualTables(fibre, parameters.formulas)) {
  for (double* density : {&parameters_.forwardDensity, &parameters_.backwardDensity}) {
    *density = *density >= 0 ? std::min(*density, 1.0) : 0;
  }
}

FibreMeans DualScattering::means(double theta, int channel) const {
  return fibreMeans(fibre_, tables_, theta, channel);
}

Vec3 DualScattering::forwardAttenuation(double theta) const {
  return overInclination(tables_.forwardAttenuation, tables_.inclinations, theta);
}

Vec3 DualScattering::forwardVariance(double theta) const {
  return overInclination(tables_.forwardVariance, tables_.inclinations, theta);
}

Vec3 DualScattering::single(const Vec3& wi, const Vec3& wo, const Vec3& variance, bool scattered) const {
  const double thetaI = inclinationOf(wi), thetaO = inclinationOf(wo);
  const double at = fibre_.azimuthalInclination(thetaI, thetaO), phi = azimuthBetween(wi, wo);
  const auto& table = scattered ? tables_.azimuthalScattered : tables_.azimuthal;
  const bool grey = variance.minCoeff() == variance.maxCoeff();
  Vec3 sum = Vec3::Zero();
  for (int p = 0; p < 4; ++p) {
    const Vec3 azimuthal = overAzimuth(tables_, table, p, at, phi);
    if (azimuthal.maxCoeff() <= 0) continue;
    Vec3 along = Vec3::Constant(fibre_.longitudinal(kFibreLobes[p], thetaI, thetaO, variance[0]));
    for (int c = 1; c < 3 && !grey; ++c) {
      along[c] = fibre_.longitudinal(kFibreLobes[p], thetaI, thetaO, variance[c]);
    }
    sum += azimuthal.cwiseProduct(along);
  }
  return sum;
}

Vec3 DualScattering::back(const Vec3& wi, const Vec3& wo, const Vec3& variance, bool scattered) const {
  const double azimuthal = backwardAzimuth(azimuthBetween(wi, wo), scattered);
  if (azimuthal == 0) return Vec3::Zero();
  const bool printed = parameters_.formulas == DualFormulas::Printed;
  const double thetaI = inclinationOf(wi), thetaO = inclinationOf(wo), theta = (thetaO - thetaI) / 2;
  const Vec3 attenuation = overInclination(tables_.backscatterAttenuation, tables_.inclinations, theta);
  const Vec3 shift = overInclination(tables_.backscatterShift, tables_.inclinations, theta);
  const Vec3 spread = overInclination(tables_.backscatterVariance, tables_.inclinations, theta);
  Vec3 out;
  for (int c = 0; c < 3; ++c) {
    const Backscatter one{attenuation[c], shift[c], spread[c]};
    out[c] = printed ? kPrintedBackscatterFactor * printedSpread(thetaI, thetaO, one, variance[c])
                     : correctedSpread(thetaI, thetaO, one, variance[c]);
  }
  return out.cwiseProduct(attenuation) * azimuthal;
}

Vec3 DualScattering::evaluate(const Vec3& wi, const Vec3& wo, const ForwardScattering& arriving) const {
  return shade(wi, wo, arriving, std::nullopt);
}

Vec3 DualScattering::evaluate(const Vec3& wi, const Vec3& wo, const ForwardScattering& arriving,
                              double h) const {
  return shade(wi, wo, arriving, h);
}

Vec3 DualScattering::shade(const Vec3& wi, const Vec3& wo, const ForwardScattering& arriving,
                           std::optional<double> h) const {
  if (!wi.allFinite() || !wo.allFinite()) return Vec3::Zero();
  const double direct = arriving.directFraction >= 0 ? std::min(arriving.directFraction, 1.0) : 0;
  Vec3 scattered, variance;
  for (int c = 0; c < 3; ++c) {  // filtered maps may leave less than the direct part, or worse
    const double more = std::min(arriving.transmittance[c], 1.0) - direct;
    scattered[c] = more > 0 ? more * parameters_.forwardDensity : 0;
    variance[c] = arriving.variance[c] > 0 ? std::min(arriving.variance[c], 10.0) : 0;
  }
  Vec3 out = Vec3::Zero();
  if (direct > 0) {
    const Vec3 none = Vec3::Zero();
    const Vec3 once = h ? fibre_.evaluate(wi, wo, *h) : single(wi, wo, none, false);
    out += direct * (once + parameters_.backwardDensity * back(wi, wo, none, false));
  }
  if (scattered.maxCoeff() > 0) {
    out += scattered.cwiseProduct(single(wi, wo, variance, true) +
                                  parameters_.backwardDensity * back(wi, wo, variance, true));
  }
  return out;
}

Vec3 DualScattering::turned(const Vec3& wi, const Vec3& wo, const ForwardScattering& arriving) const {
  const double at = fibre_.azimuthalInclination(inclinationOf(wi), inclinationOf(wo)),
               phi = azimuthBetween(wi, wo);
  const double direct = arriving.directFraction;
  Vec3 out = Vec3::Zero();
  for (int p = 0; p < 4; ++p) {
    if (direct > 0) out += direct * overAzimuth(tables_, tables_.azimuthal, p, at, phi);
    if (direct < 1) {
      const Vec3 scattered = (arriving.transmittance.array() - direct).cwiseMax(0.0);
      out += scattered.cwiseProduct(overAzimuth(tables_, tables_.azimuthalScattered, p, at, phi));
    }
  }
  return kPi * out;
}

Vec3 DualScattering::backscatterShare(double theta, double behind) const {
  const Vec3 f = forwardAttenuation(theta);
  const Vec3 b = overInclination(tables_.backwardAttenuation, tables_.inclinations, theta);
  Vec3 share;
  for (int c = 0; c < 3; ++c) {
    const double endless = backscatterOfPile(f[c], b[c], std::numeric_limits<double>::infinity());
    share[c] = endless > 0 ? std::min(1.0, backscatterOfPile(f[c], b[c], behind) / endless) : 0;
  }
  return share;
}

Vec3 DualScattering::evaluate(const Vec3& wi, const Vec3& wo, const SurroundingLight& arriving,
                              double h) const {
  if (!wi.allFinite() || !wo.allFinite()) return Vec3::Zero();
  Vec3 out = Vec3::Zero();
  const double ray = parameters_.forwardDensity / double(std::max<std::size_t>(1, arriving.arrivals.size()));
  for (const SurroundingLight::Arrival& one : arriving.arrivals) {
    if (!(one.transmittance.maxCoeff() > 0)) continue;
    out +=
        ray * one.transmittance.cwiseProduct(single(one.direction, wo, one.variance.cwiseMin(10.0), false));
  }
  if (arriving.directFraction > 0) out += arriving.directFraction * fibre_.evaluate(wi, wo, h);
  const ForwardScattering& behind = arriving.behind;
  const Vec3 returned = kReachesOverBehind * parameters_.backwardDensity * arriving.backscatter;
  if (behind.directFraction > 0) {
    out += behind.directFraction * returned.cwiseProduct(back(wi, wo, Vec3::Zero(), false));
  }
  const Vec3 scattered = (behind.transmittance.array() - behind.directFraction).cwiseMax(0.0);
  if (scattered.maxCoeff() > 0) {
    out += scattered.cwiseProduct(returned).cwiseProduct(back(wi, wo, behind.variance.cwiseMin(10.0), true));
  }
  return out;
}

void ForwardPath::cross(const DualScattering& hair, double theta, double count) {
  if (!(count > 0)) return;
  blocked_ = true;
  logTransmittance_ += count * hair.forwardAttenuation(theta).cwiseMax(1e-30).array().log().matrix();
  variance_ += count * hair.forwardVariance(theta);
}

ForwardScattering ForwardPath::result() const {
  return {blocked_ ? 0.0 : 1.0, logTransmittance_.array().exp().matrix(), variance_};
}

}  // namespace coif
