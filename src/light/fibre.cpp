#include "coif/light/fibre.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fibre_model.h"

namespace coif {
namespace {

constexpr double kPi = std::numbers::pi;

// A direction by inclination and azimuth.
struct Bearing {
  Inclination theta;
  double phi = 0;
  explicit Bearing(const Vec3& w) : theta(Inclination::ofSine(w.x())), phi(std::atan2(w.z(), w.y())) {}
};

bool usable(const Vec3& wi, const Vec3& wo, double h) {
  return wi.allFinite() && wo.allFinite() && std::isfinite(h);
}

}  // namespace

struct FibreScattering::Impl : FibreModelTerms {
  using FibreModelTerms::FibreModelTerms;
};

FibreScattering::FibreScattering(const FibreParameters& parameters)
    : impl_(std::make_unique<Impl>(parameters)) {}
FibreScattering::~FibreScattering() = default;
FibreScattering::FibreScattering(const FibreScattering& other)
    : impl_(std::make_unique<Impl>(*other.impl_)) {}
FibreScattering& FibreScattering::operator=(const FibreScattering& other) {
  *impl_ = *other.impl_;
  return *this;
}

const FibreParameters& FibreScattering::parameters() const {
  return impl_->parameters;
}

Vec3 FibreScattering::evaluate(const Vec3& wi, const Vec3& wo, double h) const {
  if (!usable(wi, wo, h)) return Vec3::Zero();
  const Bearing i(wi), o(wo);
  const Crossing crossing = impl_->cross(i.theta, o.theta, h);
  Vec3 sum = Vec3::Zero();
  for (int p = 0; p < 4; ++p) {
    sum += crossing.attenuation[p] *
           (impl_->longitudinal(p, i.theta, o.theta, 0) * impl_->azimuth(p, crossing, i.phi - o.phi));
  }
  return sum;
}

Vec3 FibreScattering::evaluate(const Vec3& wi, const Vec3& wo) const {
  if (!usable(wi, wo, 0)) return Vec3::Zero();
  const Bearing i(wi), o(wo);
  const double phi = i.phi - o.phi;
  std::array<Vec3, 4> azimuthal;
  impl_->meanAzimuths(i.theta, o.theta, {&phi, 1}, {&azimuthal, 1});
  Vec3 sum = Vec3::Zero();
  for (int p = 0; p < 4; ++p) sum += azimuthal[p] * impl_->longitudinal(p, i.theta, o.theta, 0);
  return sum;
}

FibreSample FibreScattering::sample(const Vec3& wo, double h, const std::array<double, 4>& u) const {
  FibreSample sample;
  if (!usable(wo, wo, h)) return sample;
  const Bearing o(wo);
  const std::array<double, 4> chances = impl_->chances(o.theta, h);
  int lobe = 0;
  double left = u[0];
  while (lobe < 3 && left >= chances[lobe]) left -= chances[lobe++];
  while (lobe > 0 && chances[lobe] <= 0) --lobe;  // rounding left `left` past the last one
  const Inclination i = impl_->sampleInclination(lobe, o.theta, u[1], u[2]);
  const Crossing crossing = impl_->cross(i, o.theta, h);
  const double phi = o.phi + impl_->sampleAzimuth(lobe, crossing, u[3]);
  sample.direction = Vec3(i.sin, i.cos * std::cos(phi), i.cos * std::sin(phi));
  const FibreModelTerms::Both both = impl_->both(i, o.theta, crossing, chances, phi - o.phi);
  sample.pdf = std::isfinite(both.pdf) ? both.pdf : 0;
  if (sample.pdf > 0) sample.weight = both.value / both.pdf;
  return sample;
}

double FibreScattering::pdf(const Vec3& wi, const Vec3& wo, double h) const {
  if (!usable(wi, wo, h)) return 0;
  const Bearing i(wi), o(wo);
  const std::array<double, 4> chances = impl_->chances(o.theta, h);
  const Crossing crossing = impl_->cross(i.theta, o.theta, h);
  double sum = 0;
  for (int p = 0; p < 4; ++p) {
    if (chances[p] <= 0) continue;
    sum += chances[p] * impl_->proposal(p, i.theta, o.theta) * impl_->azimuth(p, crossing, i.phi - o.phi);
  }
  return sum;
}

double FibreScattering::longitudinal(FibreLobe lobe, double thetaI, double thetaO,
                                     double extraVariance) const {
  return impl_->longitudinal(int(lobe), Inclination::ofAngle(thetaI), Inclination::ofAngle(thetaO),
                             std::max(0.0, extraVariance));
}

std::array<Vec3, 4> FibreScattering::azimuthal(double thetaI, double thetaO, double phi) const {
  return azimuthal(thetaI, thetaO, std::span(&phi, 1)).front();
}

std::vector<std::array<Vec3, 4>> FibreScattering::azimuthal(double thetaI, double thetaO,
                                                            std::span<const double> phis) const {
  std::vector<std::array<Vec3, 4>> out(phis.size());
  impl_->meanAzimuths(Inclination::ofAngle(thetaI), Inclination::ofAngle(thetaO), phis, out);
  return out;
}

Vec3 FibreScattering::azimuthal(FibreLobe lobe, double thetaI, double thetaO, double phi) const {
  return azimuthal(thetaI, thetaO, phi)[std::size_t(lobe)];
}

std::array<Vec3, 4> FibreScattering::attenuation(double thetaI, double thetaO) const {
  return impl_->meanAttenuation(Inclination::ofAngle(thetaI), Inclination::ofAngle(thetaO));
}

double FibreScattering::azimuthalInclination(double thetaI, double thetaO) const {
  const bool marschner = parameters().model == FibreModel::Marschner;
  return std::abs(marschner ? (thetaO - thetaI) / 2 : thetaO);
}

double FibreScattering::lobeShift(FibreLobe lobe) const {
  return impl_->shifts[std::size_t(lobe)];
}
double FibreScattering::lobeVariance(FibreLobe lobe) const {
  return impl_->variances[std::size_t(lobe)];
}

}  // namespace coif
