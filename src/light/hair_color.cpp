#include "coif/light/hair_color.h"

#include <algorithm>
#include <cmath>

namespace coif {
namespace {

const Vec3 kEumelanin(0.419, 0.697, 1.37);
const Vec3 kPheomelanin(0.187, 0.4, 1.05);

double atLeastZero(double value) {
  return value > 0 ? value : 0;
}

// (log albedo / this)² is the absorption.
double inversionScale(double roughness) {
  const double b = roughness >= 0 ? std::min(roughness, 1.0) : 0;
  return 5.969 + b * (-0.215 + b * (2.532 + b * (-10.73 + b * (5.574 + b * 0.245))));
}

}  // namespace

Vec3 absorptionFromMelanin(const Melanin& amounts) {
  return atLeastZero(amounts.eumelanin) * kEumelanin + atLeastZero(amounts.pheomelanin) * kPheomelanin;
}

Vec3 absorptionFromAlbedo(const Vec3& albedo, double azimuthalRoughness) {
  Vec3 out;
  for (int c = 0; c < 3; ++c) {
    const double held = albedo[c] >= 1e-4 ? std::min(albedo[c], 1.0) : 1e-4;
    const double root = std::log(held) / inversionScale(azimuthalRoughness);
    out[c] = root * root;
  }
  return out;
}

Vec3 albedoFromAbsorption(const Vec3& absorption, double azimuthalRoughness) {
  Vec3 out;
  for (int c = 0; c < 3; ++c) {
    out[c] = std::exp(-std::sqrt(atLeastZero(absorption[c])) * inversionScale(azimuthalRoughness));
  }
  return out;
}

Vec3 absorptionOf(HairColor color) {
  switch (color) {
    case HairColor::Black:
      return absorptionFromMelanin({8, 0});
    case HairColor::Brown:
      return absorptionFromMelanin({1.3, 0.2});
    case HairColor::Red:
      return absorptionFromMelanin({0.2, 1.1});
    case HairColor::Blond:
      return absorptionFromMelanin({0.15, 0.15});
    case HairColor::Grey:
      return absorptionFromMelanin({0.12, 0.0}).mean() * Vec3::Ones();
    case HairColor::Dyed:
      return absorptionFromAlbedo(Vec3(0.05, 0.25, 0.45), 0.3);
  }
  return Vec3::Zero();
}

const char* nameOf(HairColor color) {
  switch (color) {
    case HairColor::Black:
      return "black";
    case HairColor::Brown:
      return "brown";
    case HairColor::Red:
      return "red";
    case HairColor::Blond:
      return "blond";
    case HairColor::Grey:
      return "grey";
    case HairColor::Dyed:
      return "dyed";
  }
  return "";
}

}  // namespace coif
