#include "coif/light/dual_scattering.h"

#include <gtest/gtest.h>

#include "coif/base/random.h"
#include "coif/light/hair_color.h"
#include "fibre_quadrature.h"

namespace coif {
namespace {

constexpr DualFormulas kBoth[] = {DualFormulas::Printed, DualFormulas::Corrected};
const double kPi = std::numbers::pi;

FibreParameters hairOf(const Vec3& absorption, FibreModel model = FibreModel::Chiang) {
  FibreParameters parameters;
  parameters.model = model;
  parameters.absorption = absorption;
  return parameters;
}

// Light among layers of fibres, followed event by event: what comes back out of the first, and how often it
// was scattered on the way. Independent of any formula.
struct Walked {
  double returned = 0, forwards = 0, backwards = 0;
};
Walked walkLayers(double f, double b, int layers = 300) {
  constexpr int steps = 4000;
  struct Light {
    double weight = 0, forwards = 0, backwards = 0;
  };
  const auto count = std::size_t(layers);
  std::vector<Light> in(count),
      out(count);  // about to meet layer k, on the way in and on the way out
  in[0].weight = 1;
  Walked walked;
  const auto passOn = [](Light& to, const Light& from, double factor, int forwards, int backwards) {
    to.weight += factor * from.weight;
    to.forwards += factor * (from.forwards + forwards * from.weight);
    to.backwards += factor * (from.backwards + backwards * from.weight);
  };
  for (int step = 0; step < steps; ++step) {
    std::vector<Light> nextIn(count), nextOut(count);
    Light left;
    for (int k = 0; k < layers; ++k) {
      if (k + 1 < layers) passOn(nextIn[k + 1], in[k], f, 1, 0);
      passOn(k > 0 ? nextOut[k - 1] : left, in[k], b, 0, 1);
      passOn(k > 0 ? nextOut[k - 1] : left, out[k], f, 1, 0);
      if (k + 1 < layers) passOn(nextIn[k + 1], out[k], b, 0, 1);
    }
    walked.returned += left.weight;
    walked.forwards += left.forwards;
    walked.backwards += left.backwards;
    in = std::move(nextIn), out = std::move(nextOut);
  }
  walked.returned -= b;  // the first back-scattering belongs to single scattering
  walked.backwards -= b;
  walked.forwards /= walked.returned;
  walked.backwards /= walked.returned;
  return walked;
}

TEST(Backscatter, ClosedFormIsTheSumOverAllPaths) {
  for (const auto& [f, b] :
       {std::pair(0.3, 0.1), std::pair(0.6, 0.2), std::pair(0.75, 0.15), std::pair(0.2, 0.7)}) {
    const Walked walked = walkLayers(f, b);
    const FibreMeans means{f, b, 0.01, -0.02, 0.05, 0.03};
    const Backscatter back = backscatterOf(means, DualFormulas::Corrected);
    // What is left among 300 layers after 4000 steps is below 1e-9.
    EXPECT_NEAR(back.attenuation, walked.returned, 1e-8);
    EXPECT_NEAR(back.shift, walked.forwards * 0.01 - walked.backwards * 0.02, 1e-7);
    EXPECT_NEAR(back.variance, walked.forwards * 0.05 + walked.backwards * 0.03, 1e-6);
  }
}

TEST(Backscatter, PileOfPlatesIsTheSumOverAllPathsInIt) {
  for (const auto& [f, b] : {std::pair(0.5, 0.3), {0.2, 0.05}, {0.7, 0.29}, {0.6, 0.0}, {0.0, 0.4}}) {
    EXPECT_NEAR(backscatterOfPile(f, b, 0), 0, 1e-12);
    for (const int behind : {1, 2, 5, 20}) {
      EXPECT_NEAR(backscatterOfPile(f, b, behind), walkLayers(f, b, behind + 1).returned, 1e-10) << behind;
    }
    FibreMeans means;
    means.attenuationForward = f, means.attenuationBackward = b;
    EXPECT_NEAR(backscatterOfPile(f, b, HUGE_VAL), backscatterOf(means, DualFormulas::Corrected).attenuation,
                1e-12);
  }
  // Without absorption a pile returns n b / (1 + (n − 1) b); the loss that closed forms are held at, 1e-9, is
  // met some thousands of times.
  EXPECT_NEAR(backscatterOfPile(0.6, 0.4, 9), 10 * 0.4 / (1 + 9 * 0.4) - 0.4, 1e-5);
}

TEST(Backscatter, PrintedAttenuationIsTheSumsOfThePaper) {
  const double f = 0.7, b = 0.2;
  double once = 0, thrice = 0;
  for (int i = 1; i < 200; ++i) {
    once += b * std::pow(f, 2 * i);
    for (int j = 0; j < i; ++j) {
      for (int k = j + 1; k < 200; ++k) thrice += b * b * b * std::pow(f, 2 * (i - j - 1 + k));
    }
  }
  const Backscatter back = backscatterOf({f, b, 0, 0, 0.05, 0.05}, DualFormulas::Printed);
  EXPECT_NEAR(back.attenuation, once + thrice, 1e-9);
}

TEST(Backscatter, FormulasAgreeWhereLittleIsScatteredBack) {
  const FibreMeans means{0.5, 1e-4, 0.01, -0.02, 0.05, 0.05};
  const Backscatter printed = backscatterOf(means, DualFormulas::Printed);
  const Backscatter corrected = backscatterOf(means, DualFormulas::Corrected);
  EXPECT_NEAR(printed.attenuation, corrected.attenuation, 1e-10);  // differ by b³
  EXPECT_NEAR(printed.shift, corrected.shift, 1e-6);
  // (17) is a fit: within a quarter.
  EXPECT_NEAR(printed.variance, corrected.variance, 0.25 * corrected.variance);
}

TEST(Backscatter, LosslessClusterReturnsEverything) {
  for (const double b : {0.05, 0.3, 0.9}) {
    const Backscatter back = backscatterOf({1 - b, b, 0.1, 0.1, 0.1, 0.1}, DualFormulas::Corrected);
    // The loss is held at 1e-9; what is lost then is of the order of its root over b.
    EXPECT_NEAR(b + back.attenuation, 1, 2e-3);
    for (const DualFormulas formulas : kBoth) {
      const Backscatter held = backscatterOf({1, 1, 1, 1, 1, 1}, formulas);
      EXPECT_TRUE(std::isfinite(held.attenuation + held.shift + held.variance));
      EXPECT_LE(held.attenuation, 1);
    }
  }
}

TEST(DualScattering, MeansAreTheIntegralsOverHalfCones) {
  const FibreScattering fibre(hairOf(Vec3(0, 0.2, 1)));
  const DualScattering hair(fibre);
  for (const double theta : {0.0, 0.7, -1.2}) {
    // (6), (12) with the light's cone as the fixed side, as a path from the eye meets it
    Vec3 front = Vec3::Zero(), all = Vec3::Zero();
    constexpr int steps = 360;
    for (int s = 0; s < steps; ++s) {
      const double phi = 2 * kPi * (s + 0.5) / steps, turn = std::min(phi, 2 * kPi - phi);
      for (const Vec3& lobe : fibre.azimuthal(-theta, theta, phi)) {
        all += lobe * 2 * kPi / steps;
        front += lobe * (turn / kPi) * 2 * kPi / steps;
      }
    }
    for (int c = 0; c < 3; ++c) {
      const FibreMeans means = hair.means(theta, c);
      // 33 inclinations, 91 azimuths, linear between them
      EXPECT_NEAR(means.attenuationForward, front[c], 3e-3);
      EXPECT_NEAR(means.attenuationBackward, all[c] - front[c], 3e-3);
      if (c == 0) {
        EXPECT_NEAR(means.attenuationForward + means.attenuationBackward, 1, 1e-6);
      }
    }
  }
}

TEST(DualScattering, WithoutHairBetweenItIsTheFibre) {
  for (const FibreModel model : {FibreModel::KajiyaKay, FibreModel::Marschner, FibreModel::Chiang}) {
    DualScatteringParameters parameters;
    parameters.backwardDensity = 0;
    const FibreScattering fibre(hairOf(Vec3(0.06, 0.1, 0.2), model));
    const DualScattering hair(fibre, parameters);
    for (int k = 0; k < 30; ++k) {
      const Vec3 wi = direction(0.9 * std::sin(k), k), wo = direction(0.8 * std::cos(2.1 * k), 2.7 * k);
      const Vec3 mine = hair.evaluate(wi, wo, {}), truth = fibre.evaluate(wi, wo);
      EXPECT_LT((mine - truth).norm(), 0.02 * truth.norm() + 1e-4) << int(model) << " " << k;  // table
    }
  }
}

TEST(DualScattering, NearFieldAveragesToTheFarField) {
  const DualScattering hair{FibreScattering(hairOf(Vec3(0.06, 0.1, 0.2)))};
  const Vec3 wi = direction(0.3, 0), wo = direction(-0.2, 2.5);
  const ForwardScattering half{0.5, Vec3::Constant(0.7), Vec3::Constant(0.05)};
  Vec3 mean = Vec3::Zero();
  for (int s = 0; s < 2000; ++s) mean += hair.evaluate(wi, wo, half, (s + 0.5) / 1000 - 1) / 2000;
  const Vec3 far = hair.evaluate(wi, wo, half);
  EXPECT_LT((mean - far).norm(), 0.02 * far.norm());  // the tables'
}

TEST(DualScattering, BackscatterKeepsItsEnergy) {
  const FibreScattering fibre(hairOf(Vec3(0.1, 0.2, 0.5)));
  const DualScattering hair(fibre);
  const Vec3 wo = direction(0, 0), none = Vec3::Zero();
  for (const bool scattered : {false, true}) {
    const Vec3 total = overSphere(fibre, [&](const Vec3& wi) { return hair.back(wi, wo, none, scattered); });
    for (int c = 0; c < 3; ++c) {
      const double expected = backscatterOf(hair.means(0, c), DualFormulas::Corrected).attenuation;
      // Ā_b is taken at the difference angle, over which it varies by some per cent within the lobe.
      EXPECT_NEAR(total[c], expected, 0.1 * expected) << c << scattered;
    }
  }
}

// (22) by quadrature, with S_f of (7) whose mean arrival is the light's own inclination: f_back of light that
// comes evenly from half the cone is f_back once, not π times; f_s becomes that of N^G.
TEST(DualScattering, ScatteredLightIsTheQuadratureOfEquation22) {
  DualScatteringParameters parameters;
  const FibreScattering fibre(hairOf(Vec3(0.1, 0.2, 0.5)));
  const DualScattering hair(fibre, parameters);
  const double thetaD = 0.3, variance = 0.01;
  const Vec3 light = direction(thetaD, 0);
  for (const double phiO : {0.4, 1.9, 3.0}) {
    const Vec3 wo = direction(-0.35, phiO);
    Vec3 back = Vec3::Zero(), single = Vec3::Zero();
    constexpr int steps = 160;
    for (int t = 0; t < steps; ++t) {
      const double offset = 1.0 * (t + 0.5) / steps - 0.5, thetaI = thetaD + offset;
      const double g = std::exp(-offset * offset / (2 * variance)) / std::sqrt(2 * kPi * variance);
      for (int p = 0; p < steps; ++p) {
        const Vec3 wi = direction(thetaI, kPi * ((p + 0.5) / steps - 0.5));
        const double psi = g / (kPi * std::cos(thetaI));  // ∫ Ψ^G dω_i = 1
        const double area = std::cos(thetaI) * (1.0 / steps) * (kPi / steps);
        back += hair.back(wi, wo, Vec3::Zero(), false) * psi * area;
        single += fibre.evaluate(wi, wo) * psi * area;
      }
    }
    const Vec3 spread = Vec3::Constant(variance);
    const Vec3 backMine = hair.back(light, wo, spread, true),
               singleMine = hair.single(light, wo, spread, true);
    for (int c = 0; c < 3; ++c) {
      // Adding variances is exact for gaussians on a line; on the sphere, of this width, to a few per cent.
      EXPECT_NEAR(backMine[c], back[c], 0.05 * back[c]) << phiO;
      EXPECT_NEAR(singleMine[c], single[c], 0.05 * single[c]) << phiO;
    }
  }
}

TEST(DualScattering, HighlightsLieOppositeTheLight) {
  FibreParameters hair = hairOf(Vec3(0.1, 0.2, 0.5));
  hair.longitudinalRoughness = 0.15;
  hair.tiltRad = 0;
  const DualScattering dual{FibreScattering(hair)};
  const Vec3 light = direction(radians(40), 0);
  ForwardScattering deep;
  deep.directFraction = 0;
  deep.transmittance = Vec3::Constant(0.5);
  deep.variance = Vec3::Constant(0.02);
  for (const ForwardScattering& arriving : {ForwardScattering{}, deep}) {
    double best = 0, at = 0;
    for (double degrees = -80; degrees <= 80; degrees += 0.5) {
      const double value = dual.evaluate(light, direction(radians(degrees), 0.4), arriving).sum();
      if (value > best) best = value, at = degrees;
    }
    EXPECT_NEAR(at, -40, 6);  // wide lobes lean towards the pole by their variance · tan 40°
  }
}

TEST(DualScattering, SurroundingsAreTheStraightPathWhereHairIsEverywhere) {
  const DualScattering hair{FibreScattering(hairOf(Vec3(0.05, 0.1, 0.2)))};
  const Vec3 t(0.6, 0.5, 0.3), spread = Vec3::Constant(0.05);
  for (const auto& [theta, thetaO, phiO] : {std::tuple(0.0, 0.0, 0.0), {0.5, -0.4, 2.0}, {-0.7, 0.3, 3.0}}) {
    const Vec3 wi(std::sin(theta), std::cos(theta), 0);
    const Vec3 wo(std::sin(thetaO), std::cos(thetaO) * std::cos(phiO), std::cos(thetaO) * std::sin(phiO));
    SurroundingLight around;
    around.directFraction = 0;
    constexpr int rays = 360;
    for (int r = 0; r < rays; ++r) {
      const double phi = kPi * ((r + 0.5) / rays - 0.5);
      around.arrivals.push_back(
          {Vec3(std::sin(theta), std::cos(theta) * std::cos(phi), std::cos(theta) * std::sin(phi)), t,
           spread});
    }
    around.behind = {0, t / kReachesOverBehind, spread};
    const Vec3 even = hair.evaluate(wi, wo, ForwardScattering{0, t, spread}),
               met = hair.evaluate(wi, wo, around, 0);
    // (25) is a sum over nodes two degrees apart, joined by lines.
    EXPECT_LT((met - even).norm(), 2e-3 * even.norm());
  }
}

TEST(DualScattering, WhatAFibreTurnsIsItsForwardAttenuationOnAverage) {
  const DualScattering hair{FibreScattering(hairOf(Vec3(0.05, 0.1, 0.2)))};
  constexpr int steps = 180;
  for (const double theta : {0.0, 0.6}) {
    const Vec3 wi = direction(theta, 0);
    Vec3 even = Vec3::Zero(), afar = Vec3::Zero();
    for (int s = 0; s < steps; ++s) {
      const Vec3 wo = direction(-theta, kPi + kPi * ((s + 0.5) / steps - 0.5));
      even += hair.turned(wi, wo, {0, Vec3::Ones(), Vec3::Zero()}) / steps;
      afar += hair.turned(wi, wo, {1, Vec3::Ones(), Vec3::Zero()}) / steps;
    }
    for (int c = 0; c < 3; ++c) {
      // Sums over nodes two degrees apart.
      EXPECT_NEAR(even[c], hair.forwardAttenuation(theta)[c], 2e-3);
      // Light from afar goes straight on more readily than light that comes from all of the half circle.
      EXPECT_GT(afar[c], 1.05 * even[c]);
    }
  }
}

// Fibres at random, their cross-sections' centres Poisson's, light along −z: what reaches a point in the hair
// by what reaches the fibre behind it.
TEST(DualScattering, TheNextFibreBehindGetsTwoOverPiOfTheLight) {
  const CounterRandom random(5, 0);
  double behind = 0;
  constexpr int points = 200000;
  for (int i = 0; i < points; ++i) {
    const auto number = 2 * std::uint64_t(i);
    const double way = -std::log1p(-random.uniform(number)), phi = kPi * (random.uniform(number + 1) - 0.5);
    behind += std::exp(-way * std::cos(phi)) / points;
  }
  EXPECT_NEAR(1 / behind, kReachesOverBehind,
              5e-3);  // three standard errors: a deviation of 0.27 over 447, times 2.5
}

TEST(DualScattering, DensityFactorsEnterOnce) {
  const FibreScattering fibre(hairOf(Vec3(0.1, 0.2, 0.5)));
  const Vec3 wi = direction(0.2, 0), wo = direction(-0.1, 0.5);
  ForwardScattering deep{0, Vec3::Constant(0.5), Vec3::Constant(0.02)};
  DualScatteringParameters parameters;
  parameters.backwardDensity = 0;
  parameters.forwardDensity = 1;
  const Vec3 whole = DualScattering(fibre, parameters).evaluate(wi, wo, deep);
  parameters.forwardDensity = 0.25;
  EXPECT_LT((DualScattering(fibre, parameters).evaluate(wi, wo, deep) - whole / 4).norm(), 1e-12);
  EXPECT_LT((DualScattering(fibre, parameters).single(wi, wo, deep.variance, true) / 2 - whole).norm(),
            1e-12);
}

TEST(DualScattering, PathsAddUp) {
  const DualScattering hair{FibreScattering(hairOf(Vec3(0.1, 0.2, 0.5)))};
  ForwardPath path;
  EXPECT_EQ(path.result().directFraction, 1);
  EXPECT_EQ(path.result().transmittance, Vec3::Ones());
  path.cross(hair, 0.2);
  path.cross(hair, -0.7);
  const Vec3 product = hair.forwardAttenuation(0.2).cwiseProduct(hair.forwardAttenuation(-0.7));
  EXPECT_EQ(path.result().directFraction, 0);
  EXPECT_LT((path.result().transmittance - product).norm(), 1e-12);
  EXPECT_LT((path.result().variance - hair.forwardVariance(0.2) - hair.forwardVariance(-0.7)).norm(), 1e-12);
}

TEST(DualScattering, ExtremesStayFiniteAndNeverNegative) {
  const double nan = std::nan("");
  for (const DualFormulas formulas : kBoth) {
    for (const FibreModel model : {FibreModel::KajiyaKay, FibreModel::Marschner, FibreModel::Chiang}) {
      for (const double roughness : {1e-3, 1.0}) {
        for (const double absorption : {0.0, 1e4}) {
          FibreParameters fibre = hairOf(Vec3(absorption, 0, 1), model);
          fibre.longitudinalRoughness = fibre.azimuthalRoughness = roughness;
          DualScatteringParameters parameters;
          parameters.formulas = formulas;
          parameters.forwardDensity = nan;
          const DualScattering hair(FibreScattering(fibre), parameters);
          const ForwardScattering cases[] = {{1, Vec3::Ones(), Vec3::Zero()},
                                             {0.9, Vec3::Constant(0.2), Vec3::Constant(-1)},
                                             {nan, Vec3(nan, 2, -1), Vec3(nan, 1e9, 0)}};
          for (const ForwardScattering& arriving : cases) {
            for (const double degrees : {0.0, 40.0, 89.9, -90.0}) {
              for (const double phi : {0.0, 1.5707963, 3.14159}) {
                const Vec3 value = hair.evaluate(direction(radians(degrees), 0),
                                                 direction(-radians(degrees), phi), arriving);
                ASSERT_TRUE(value.allFinite() && (value.array() >= 0).all()) << value.transpose();
              }
            }
          }
          EXPECT_EQ(hair.evaluate(Vec3(nan, 0, 0), Vec3::UnitY(), {}), Vec3::Zero());
        }
      }
    }
  }
}

}  // namespace
}  // namespace coif
