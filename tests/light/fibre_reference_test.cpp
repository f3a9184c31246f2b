// Mitsuba 3's implementation of the same model, as numbers.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "coif/light/fibre.h"
#include "fibre_quadrature.h"

namespace coif {
namespace {

nlohmann::json references() {
  std::ifstream file(COIF_SHARED_DATA "/reference_values/mitsuba_hair_bsdf.json");
  return file ? nlohmann::json::parse(file) : nlohmann::json();
}

FibreParameters parametersOf(const nlohmann::json& entry) {
  FibreParameters parameters;
  const auto& sigma = entry["sigma_a"];
  for (int c = 0; c < 3; ++c)
    parameters.absorption[c] = sigma.is_array() ? sigma[c].get<double>() : sigma.get<double>();
  parameters.longitudinalRoughness = entry["beta_m"];
  parameters.azimuthalRoughness = entry["beta_n"];
  parameters.tiltRad = radians(entry["tilt_deg"]);
  parameters.index = 1.55 / 1.000277;
  return parameters;
}

// Theirs: fibre along y, normal z, scales leaning the other way along the axis.
Vec3 fromReference(const nlohmann::json& w) {
  return Vec3(-w[1].get<double>(), w[0], w[2]);
}

// Theirs cuts the series of the Bessel function I₀ after ten terms up to 12 and the asymptotic one after one
// term beyond: by how much the factor M of a lobe is off for that, at most.
double referenceBesselError(const FibreScattering& fibre, const Vec3& light, const Vec3& eye) {
  double worst = 0;
  for (const FibreLobe lobe : kFibreLobes) {
    const double thetaO = std::asin(eye.x()) - fibre.lobeShift(lobe);
    const double a = std::hypot(light.y(), light.z()) * std::cos(thetaO) / fibre.lobeVariance(lobe);
    double term = 1, cut = 1;
    for (int k = 1; k <= 10; ++k) cut += term *= a * a / (4.0 * k * k);
    if (a > 12) cut = std::exp(0.5 * (1 / (8 * a) - std::log(2 * std::numbers::pi * a)));
    const double exact = a > 12 ? std::cyl_bessel_i(0, std::min(a, 600.0)) * std::exp(-std::min(a, 600.0))
                                : std::cyl_bessel_i(0, a);
    if (a < 600) worst = std::max(worst, std::abs(cut / exact - 1));
  }
  return worst;
}

TEST(FibreReference, SixtyEvaluationsOfChiang) {
  const auto document = references();
  if (document.is_null()) GTEST_SKIP() << "no reference values here";
  int compared = 0, clean = 0;
  for (const auto& entry : document["eval"]) {
    const FibreScattering fibre(parametersOf(entry));
    // Theirs calls the eye's direction wi; its offset follows from the normal z.
    const Vec3 eye = fromReference(entry["wi"]), light = fromReference(entry["wo"]);
    const double h = -eye.y() / std::hypot(eye.y(), eye.z());
    const Vec3 value = fibre.evaluate(light, eye, h);
    const double bessel = referenceBesselError(fibre, light, eye);
    if (bessel < 1e-4) ++clean;
    for (int c = 0; c < 3; ++c) {
      // Single precision, exponents up to 1 / v = 250: 250 · 6e-8 and some.
      const double theirs = entry["f_cos"][c];
      EXPECT_NEAR(value[c], theirs, (1e-4 + bessel) * theirs) << entry.dump();
    }
    ++compared;
  }
  EXPECT_EQ(compared, 60);
  EXPECT_GE(clean, 18);  // these to four digits
}

TEST(FibreReference, SixtyHemisphereAveragesOfChiang) {
  const auto document = references();
  if (document.is_null()) GTEST_SKIP() << "no reference values here";
  int compared = 0, beyondThree = 0;
  for (const auto& entry : document["hemisphere_averages"]) {
    const FibreScattering fibre(parametersOf(entry));
    const double theta = -radians(entry["theta_deg"]), pi = std::numbers::pi;
    double forward = 0, backward = 0;
    constexpr int steps = 360;
    for (int s = 0; s < steps; ++s) {  // attenuation and azimuth depend on the eye's inclination alone
      const double phi = 2 * pi * (s + 0.5) / steps;
      double around = 0;
      for (const Vec3& lobe : fibre.azimuthal(-theta, theta, phi)) around += lobe.x();
      (std::cos(phi) < 0 ? forward : backward) += around * 2 * pi / steps;
    }
    const double error = entry["stderr"];
    EXPECT_NEAR(forward, entry["a_forward"].get<double>(), 4 * error) << entry.dump();
    EXPECT_NEAR(backward, entry["a_backward"].get<double>(), 4 * error) << entry.dump();
    if (std::abs(forward - entry["a_forward"].get<double>()) > 3 * error) ++beyondThree;
    // Their albedo has hardly any noise: the attenuations add up at every sample.
    EXPECT_NEAR(forward + backward, entry["albedo"].get<double>(), 5e-4) << entry.dump();
    ++compared;
  }
  EXPECT_EQ(compared, 60);
  EXPECT_LE(beyondThree, 2);  // of 60 normal deviates, 0.16 are expected
}

}  // namespace
}  // namespace coif
