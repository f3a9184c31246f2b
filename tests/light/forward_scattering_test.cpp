#include "coif/light/forward_scattering.h"

#include <gtest/gtest.h>

#include "light_fixture.h"

namespace coif {
namespace {

FibreScattering brownFibre() {
  return FibreScattering(FibreParameters{});
}

// Straight fibres along x across the unit square, at these depths below z = 0; y in the middle of a texel.
StrandSet layersOfFibres(const std::vector<double>& depths, double width) {
  StrandSet strands;
  for (const double depth : depths) {
    addStrand(strands, {Vec3f(-0.5f, 0.01f, float(-depth)), Vec3f(0.5f, 0.01f, float(-depth))}, float(width));
  }
  return strands;
}

VisibilityOptions exact() {
  VisibilityOptions options;
  options.method = VisibilityMethod::Exact;
  return options;
}

TEST(ForwardScatteringMap, MultipliesWhatEachFibreLeaves) {
  const DualScattering hair(brownFibre());
  const StrandSet strands = layersOfFibres({0.1, 0.3, 0.5}, 0.004);
  const LightView view = distantLightView(Vec3::UnitZ(), {Vec3(-0.5, -0.5, -1), Vec3(0.5, 0.5, 0)}, 64);
  const auto map = ForwardScatteringMap::build(strands, hair, view, exact());
  ASSERT_TRUE(map.ok());
  const double alpha = 0.004 / view.texel;
  for (int above = 0; above <= 3; ++above) {
    const ForwardScattering at = map->at(Vec3(0, 0.01, -0.2 * above));
    EXPECT_NEAR(at.directFraction, std::pow(1 - alpha, above), 1e-5);  // float sums
    for (int c = 0; c < 3; ++c) {
      const double forward = hair.forwardAttenuation(0)[c], one = hair.forwardVariance(0)[c];
      EXPECT_NEAR(at.transmittance[c], std::pow(1 - alpha + alpha * forward, above), 1e-5);
      if (above == 0) {
        EXPECT_EQ(at.variance[c], 0);
        continue;
      }
      // Scattered once to `above` times: k fibres met with chance α, each leaving ā_f and adding its
      // variance.
      double weight = 0, sum = 0, choose = 1;
      for (int k = 1; k <= above; ++k) {
        choose = choose * (above - k + 1) / k;
        const double w = choose * std::pow(alpha * forward, k) * std::pow(1 - alpha, above - k);
        weight += w, sum += w * k * one;
      }
      EXPECT_NEAR(at.variance[c], sum / weight, 1e-3 * one);
    }
  }
}

TEST(ForwardScatteringMap, VoxelsApproachTheExactSums) {
  const DualScattering hair(brownFibre());
  const CounterRandom random(3);
  StrandSet strands;
  for (int s = 0; s < 3000; ++s) {
    const auto u = [&](int k) { return random.uniform(std::uint64_t(8 * s + k)) - 0.5; };
    const Vec3 from(-0.5, u(0), u(1)), to(0.5, u(0) + 0.2 * u(2), u(1) + 0.2 * u(3));
    addStrand(strands, {from.cast<float>(), to.cast<float>()}, 0.003f);
  }
  const Box box{Vec3(-0.5, -0.6, -0.6), Vec3(0.5, 0.6, 0.6)};
  const LightView view = distantLightView(Vec3(0.3, 0.2, 1), box, 48);
  const auto truth = ForwardScatteringMap::build(strands, hair, view, exact());
  ASSERT_TRUE(truth.ok());
  double before = 1;
  for (const int slices : {8, 32, 128}) {
    VisibilityOptions options;
    options.method = VisibilityMethod::Opacity;
    options.slices = slices;
    const auto map = ForwardScatteringMap::build(strands, hair, view, options);
    ASSERT_TRUE(map.ok());
    double error = 0;
    for (int k = 0; k < 500; ++k) {
      const Vec3 at = 0.8 * Vec3(random.uniform(90000 + 3 * k) - 0.5, random.uniform(90001 + 3 * k) - 0.5,
                                 random.uniform(90002 + 3 * k) - 0.5);
      const ForwardScattering one = map->at(at), other = truth->at(at);
      error += (one.transmittance - other.transmittance).cwiseAbs().mean() / 500;
      EXPECT_GE(one.transmittance.minCoeff(), one.directFraction - 1e-6);
    }
    EXPECT_LT(error, 0.6 * before) << slices;  // first order in the slice's depth, until single fibres show
    before = error;
  }
  EXPECT_LT(before, 0.01);
}

TEST(ForwardScatteringMap, AHairDoesNotShadowItself) {
  const DualScattering hair(brownFibre());
  StrandSet strands;
  addStrand(strands, {Vec3f(-0.5f, -0.3f, -0.5f), Vec3f(0.5f, 0.3f, 0.5f)}, 0.02f);  // aslant to the map
  const LightView view = distantLightView(Vec3::UnitZ(), {Vec3(-0.5, -0.5, -0.5), Vec3(0.5, 0.5, 0.5)}, 32);
  const Vec3 tangent = Vec3(1, 0.6, 1).normalized();
  for (const auto method :
       {VisibilityMethod::Exact, VisibilityMethod::Opacity, VisibilityMethod::DeepOpacity}) {
    VisibilityOptions options;
    options.method = method;
    options.slices = 16;
    for (const bool filter : {false, true}) {
      options.filter = filter;
      const auto map = ForwardScatteringMap::build(strands, hair, view, options);
      ASSERT_TRUE(map.ok());
      double shadowed = 0;
      for (int i = 0; i < 40; ++i) {
        const Vec3 at = (-0.3 + 0.6 * i / 39) * Vec3(1, 0.6, 1);
        const ForwardScattering own = map->at(at, {tangent, 0.02});
        EXPECT_NEAR(own.directFraction, 1, 1e-5) << name(method);  // float sums, minus what they were made of
        EXPECT_NEAR(own.transmittance.minCoeff(), 1, 1e-5) << name(method);
        shadowed += (1 - map->at(at).directFraction) / 40;
      }
      EXPECT_GT(shadowed, 0.05);  // else there was nothing to take out
    }
  }
}

TEST(ForwardScatteringMap, FiltersWhatPassesNotItsLogarithm) {
  const DualScattering hair(brownFibre());
  const LightView view = distantLightView(Vec3::UnitZ(), {Vec3(-0.5, -0.5, -1), Vec3(0.5, 0.5, 0)}, 16);
  const double row = 0.5 * view.texel;  // the middle of a texel
  StrandSet strands;
  addStrand(strands, {Vec3f(-0.5f, float(row), 0), Vec3f(0.5f, float(row), 0)}, float(0.9 * view.texel));
  VisibilityOptions options = exact();
  options.filter = true;
  const auto map = ForwardScatteringMap::build(strands, hair, view, options);
  ASSERT_TRUE(map.ok());
  const ForwardScattering at =
      map->at(Vec3(0, row + 0.5 * view.texel, -0.5));  // half of it from the free texel
  EXPECT_NEAR(at.directFraction, 0.5 * (0.1 + 1), 1e-5);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(at.transmittance[c], 0.5 * (0.1 + 0.9 * hair.forwardAttenuation(0)[c] + 1), 1e-5);
  }
}

TEST(ForwardScatteringMap, GreyHairTakesOneChannelAndIsTheSame) {
  FibreParameters grey;
  grey.absorption = Vec3::Constant(0.1);
  const DualScattering hair{FibreScattering(grey)};
  const StrandSet strands = layersOfFibres({0.1, 0.15, 0.3, 0.5}, 0.004);
  const LightView view = distantLightView(Vec3(0.2, 0, 1), {Vec3(-0.5, -0.5, -1), Vec3(0.5, 0.5, 0)}, 64);
  VisibilityOptions options;  // seven layers
  options.filter = true;
  const auto one = ForwardScatteringMap::build(strands, hair, view, options);
  options.leaveOut = false;
  const auto three = ForwardScatteringMap::build(strands, hair, view, options);
  ASSERT_TRUE(one.ok() && three.ok());
  EXPECT_EQ(one->colorChannels(), 1u);
  EXPECT_EQ(three->colorChannels(), 3u);
  EXPECT_LT(one->map().bytesPerTexel(), 0.5 * three->map().bytesPerTexel());
  for (int i = 0; i < 200; ++i) {
    const Vec3 at(0.002 * i - 0.2, 0.01 + 0.0001 * i, -0.003 * i);
    const OwnHair own{Vec3::UnitX(), i % 2 == 0 ? 0.0 : 0.004};
    const ForwardScattering a = one->at(at, own), b = three->at(at, own);
    EXPECT_EQ(a.directFraction, b.directFraction);
    EXPECT_EQ(a.transmittance, b.transmittance);
    EXPECT_EQ(a.variance, b.variance);
  }
  const auto brown = ForwardScatteringMap::build(strands, DualScattering(brownFibre()), view, {});
  ASSERT_TRUE(brown.ok());
  EXPECT_EQ(brown->colorChannels(), 3u);
}

TEST(ForwardScatteringMap, NoHairIsNoShadow) {
  const DualScattering hair(brownFibre());
  const LightView view = distantLightView(Vec3::UnitZ(), {}, 16);
  const auto map = ForwardScatteringMap::build(StrandSet{}, hair, view, exact());
  ASSERT_TRUE(map.ok());
  const ForwardScattering at = map->at(Vec3(0.1, 0.1, 0.1));
  EXPECT_EQ(at.directFraction, 1);
  EXPECT_EQ(at.transmittance, Vec3::Ones());
}

TEST(ForwardScatteringMap, ExtremesGiveNumbers) {
  StrandSet broken = wavyStrands(3, 0.05f);
  broken.points[4].x() = NAN;
  StrandSet heap;
  const LightView square = squareView(8);
  for (int i = 0; i < 500; ++i) addAcross(heap, square, 3, 3, 0.5, 1);
  const LightView inside = pointLightView(Vec3(0.5, 0.5, 0.5), {Vec3::Zero(), Vec3::Ones()}, 8);
  for (const double absorption : {0.0, 1e4}) {
    for (const double roughness : {1e-3, 1.0}) {
      FibreParameters fibre;
      fibre.absorption = Vec3(absorption, 0, 1);
      fibre.longitudinalRoughness = fibre.azimuthalRoughness = roughness;
      const DualScattering hair{FibreScattering(fibre)};
      for (const StrandSet& set :
           {wavyStrands(1, 0.1f), wavyStrands(1, 0.0f), heap, broken, wavyStrands(50, 1e-6f)}) {
        for (const LightView& view : {square, inside}) {
          const auto map = ForwardScatteringMap::build(set, hair, view, exact());
          ASSERT_TRUE(map.ok()) << map.error().text();
          for (std::uint64_t i = 0; i < 50; ++i) {
            const CounterRandom random(3, i);
            const Vec3 p(1.5 * random.uniform(0), random.uniform(1), 1.5 * random.uniform(2));
            const ForwardScattering at = map->at(p, {Vec3::UnitX(), 0.05});
            ASSERT_TRUE(at.directFraction >= 0 && at.directFraction <= 1);
            ASSERT_TRUE(at.transmittance.minCoeff() >= 0 && at.transmittance.maxCoeff() <= 1);
            ASSERT_TRUE(at.variance.allFinite() && at.variance.minCoeff() >= 0);
          }
        }
      }
    }
  }
  EXPECT_EQ(FragmentStream::make(broken, square).value().droppedStrands(), 1u);
}

}  // namespace
}  // namespace coif
