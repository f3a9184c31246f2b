#include "coif/light/visibility.h"

#include <gtest/gtest.h>

#include <numeric>

#include "light/cluster_bins.h"
#include "light/light_fixture.h"

namespace coif {
namespace {

using Map = std::unique_ptr<VisibilityMap>;

constexpr VisibilityMethod kMapped[] = {VisibilityMethod::Opacity, VisibilityMethod::DensityClustering,
                                        VisibilityMethod::DeepOpacity, VisibilityMethod::Occupancy,
                                        VisibilityMethod::Exact};

Map build(const StrandSet& set, const LightView& view, VisibilityOptions options, int threads = 0) {
  Context context;
  context.threads = threads;
  const FragmentStream stream = FragmentStream::make(set, view, {}, context).value();
  auto map = buildVisibility(stream, options, {}, context);
  EXPECT_TRUE(map.ok()) << (map.ok() ? "" : map.error().text());
  return std::move(map).value();
}

VisibilityOptions method(VisibilityMethod m) {
  VisibilityOptions options;
  options.method = m;
  return options;
}

/// One fragment a depth in texel (1, 1) of a 4 × 4 map.
StrandSet column(const std::vector<double>& depths, double alpha) {
  StrandSet set;
  for (const double depth : depths) addAcross(set, squareView(4), 1, 1, depth, alpha);
  return set;
}
Vec3 inColumn(double depth) {
  return Vec3(1.5 / 4, 1.5 / 4, 1 - depth);
}
std::vector<double> spread(double from, double to, int count) {
  std::vector<double> depths;
  for (int i = 0; i < count; ++i) depths.push_back(from + (to - from) * (i + 0.5) / count);
  return depths;
}
/// Mean |T − T of the truth| over points inside the unit cube.
double meanError(const VisibilityMap& map, const VisibilityMap& truth) {
  constexpr int kPoints = 4000;
  double sum = 0;
  for (int i = 0; i < kPoints; ++i) {
    const CounterRandom random(11, std::uint64_t(i));
    const Vec3 p(random.uniform(0), random.uniform(1), random.uniform(2));
    sum += std::abs(map.transmittance(p) - truth.transmittance(p));
  }
  return sum / kPoints;
}

TEST(Visibility, OneLayerIsAStepForEveryMethod) {
  const StrandSet set = column({0.5}, 0.3);
  for (const VisibilityMethod m : kMapped) {
    const Map map = build(set, squareView(4), method(m));
    EXPECT_DOUBLE_EQ(map->transmittance(inColumn(0.4)), 1) << name(m);
    EXPECT_NEAR(map->transmittance(inColumn(0.6)), 0.7, 1e-6) << name(m);  // α is a float
    EXPECT_NEAR(map->opticalDepth(inColumn(0.6)), -std::log1p(-0.3), 1e-6) << name(m);
    EXPECT_DOUBLE_EQ(map->transmittance(Vec3(0.9, 0.9, 0)), 1) << name(m);  // another texel
    EXPECT_DOUBLE_EQ(map->transmittance(Vec3(7, 7, 0)), 1) << name(m);      // off the map
  }
}

TEST(Visibility, FragmentDoesNotShadowItself) {
  // Exactly representable depths, so that a query meets the fragment's own depth.
  const StrandSet set = column({0.25, 0.5, 0.75}, 0.5);
  for (const VisibilityMethod m : kMapped) {
    EXPECT_DOUBLE_EQ(build(set, squareView(4), method(m))->transmittance(inColumn(0.25)), 1) << name(m);
  }
  const Map exact = build(set, squareView(4), method(VisibilityMethod::Exact));
  EXPECT_NEAR(exact->transmittance(inColumn(0.5)), 0.5, 1e-6);
  EXPECT_NEAR(exact->transmittance(inColumn(0.75)), 0.25, 1e-6);
}

TEST(Visibility, UniformFogThickensLinearly) {
  const StrandSet set = column(spread(0.2, 0.8, 1200), 0.002);
  const double total = -1200 * std::log1p(-0.002);
  for (const VisibilityMethod m : kMapped) {
    VisibilityOptions options = method(m);
    options.sizes = LayerSizes::Constant;
    const Map map = build(set, squareView(4), options);
    // Clusters overlap or leave gaps where √3 σ of a uniform quarter is rounded: none in theory; the others
    // are linear between exact values. One fragment is 1/1200 of the total.
    for (const double depth : {0.21, 0.35, 0.5, 0.65, 0.79}) {
      EXPECT_NEAR(map->opticalDepth(inColumn(depth)), total * (depth - 0.2) / 0.6, 3 * total / 1200)
          << name(m);
    }
  }
}

TEST(Visibility, TwoSlabsLeaveTheGapLevel) {
  std::vector<double> depths = spread(0.2, 0.25, 50);
  for (const double d : spread(0.7, 0.8, 100)) depths.push_back(d);
  const StrandSet set = column(depths, 0.01);
  const double beta = -std::log1p(-0.01);
  for (const VisibilityMethod m : kMapped) {
    const Map map = build(set, squareView(4), method(m));
    const double within = m == VisibilityMethod::DeepOpacity ? 0.2 : 0.02;  // seven layers blur the gap
    EXPECT_NEAR(map->transmittance(inColumn(0.5)), std::exp(-50 * beta), within) << name(m);
    EXPECT_NEAR(map->transmittance(inColumn(0.95)), std::exp(-150 * beta), 1e-5) << name(m);
  }
}

TEST(Visibility, ExactIsTheSumInFrontOfThePoint) {
  const StrandSet set = wavyStrands(500, 0.004f);
  const LightView view = squareView(16);
  const FragmentStream stream = FragmentStream::make(set, view).value();
  const auto fragments = collect(stream);
  const Map map = build(set, view, method(VisibilityMethod::Exact));
  for (std::uint64_t i = 0; i < 200; ++i) {
    const CounterRandom random(5, i);
    const Vec3 p(random.uniform(0), random.uniform(1), random.uniform(2));
    const Vec3 q = view.project(p);
    const std::uint32_t texel = std::uint32_t(int(q.y()) * view.size + int(q.x()));
    double omega = 0;
    for (const Fragment& f : fragments) omega += f.texel == texel && f.depth < float(q.z()) ? f.beta() : 0.0;
    EXPECT_NEAR(map->opticalDepth(p), omega, 1e-6 * (1 + omega));  // stored as float
  }
}

TEST(Visibility, MethodsApproachTheTruthAsTheyAreRefined) {
  const StrandSet set = wavyStrands(3000, 0.003f);
  const LightView view = squareView(24);
  const Map truth = build(set, view, method(VisibilityMethod::Exact));
  const auto errorsOf = [&](auto refine) {
    std::vector<double> errors;
    for (int i = 0; i < 4; ++i) errors.push_back(meanError(*build(set, view, refine(i)), *truth));
    return errors;
  };
  const auto opacity = errorsOf([&](int i) {
    VisibilityOptions o = method(VisibilityMethod::Opacity);
    o.slices = 8 << (2 * i);
    return o;
  });
  const auto deep = errorsOf([&](int i) {
    VisibilityOptions o = method(VisibilityMethod::DeepOpacity);
    o.sizes = LayerSizes::Constant;
    o.layers = 3 << (2 * i);
    return o;
  });
  const auto occupancy = errorsOf([&](int i) {
    VisibilityOptions o = method(VisibilityMethod::Occupancy);
    o.slabs = 1 << i;
    o.occupancySlices = 128 << i;
    return o;
  });
  // Fragments are points: between two planes Ω is a step function, so the error falls as the number of
  // planes to the power 1 once planes are as close as fragments, and as 1/2 (shot noise) before.
  for (const auto& errors : {opacity, deep}) {
    for (std::size_t i = 1; i < errors.size(); ++i) EXPECT_LT(errors[i], 0.62 * errors[i - 1]);
    EXPECT_LT(errors.back(), 0.003);
  }
  for (std::size_t i = 1; i < occupancy.size(); ++i) EXPECT_LT(occupancy[i], occupancy[i - 1]);
  EXPECT_LT(occupancy.back(), 0.003);
}

TEST(Visibility, ErrorStaysWithinTheReportedBound) {
  const StrandSet set = wavyStrands(1500, 0.006f);
  const LightView view = squareView(24);
  const Map truth = build(set, view, method(VisibilityMethod::Exact));
  std::vector<VisibilityOptions> all{method(VisibilityMethod::Opacity), method(VisibilityMethod::Occupancy)};
  all[0].slices = 12;
  for (const PastLastLayer past :
       {PastLastLayer::Ignore, PastLastLayer::AddToLast, PastLastLayer::EnlargeLast}) {
    for (const LayerSizes law :
         {LayerSizes::Constant, LayerSizes::Linear, LayerSizes::PowersOfTwo, LayerSizes::Fibonacci}) {
      VisibilityOptions o = method(VisibilityMethod::DeepOpacity);
      o.past = past, o.sizes = law, o.layers = 5;
      all.push_back(o);
    }
  }
  for (const VisibilityOptions& o : all) {
    const Map map = build(set, view, o);
    const double worst = map->aPosterioriBound().worst;
    for (std::uint64_t i = 0; i < 2000; ++i) {
      const CounterRandom random(13, i);
      const Vec3 p(random.uniform(0), random.uniform(1), random.uniform(2));
      const double error = std::abs(map->transmittance(p) - truth->transmittance(p));
      ASSERT_LE(error, map->boundAt(p) + 1e-5) << name(o.method);  // sums in float
      if (o.past != PastLastLayer::Ignore || o.method != VisibilityMethod::DeepOpacity) {
        ASSERT_LE(map->boundAt(p), worst + 1e-5) << name(o.method);
      }
    }
  }
}

TEST(Visibility, AutomaticLayersMeetTheirBoundAndAreTheFewest) {
  const StrandSet set = wavyStrands(6000, 0.002f);
  const LightView view = squareView(32);
  const Map truth = build(set, view, method(VisibilityMethod::Exact));
  int before = 0;
  for (const double bound : {0.4, 0.2, 0.1}) {
    VisibilityOptions o = method(VisibilityMethod::DeepOpacity);
    o.layers = 0;
    o.bound = bound;
    const Map map = build(set, view, o);
    EXPECT_LE(map->aPosterioriBound().mean, bound);
    EXPECT_LE(meanError(*map, *truth), bound);
    EXPECT_GT(map->options().layers, before);
    before = map->options().layers;
    if (before > 3) {
      o.layers = before <= 15 ? before - 4 : before <= 31 ? before - 8 : before - 16;  // the choice before
      EXPECT_GT(build(set, view, o)->aPosterioriBound().mean, bound);
    }
  }
}

TEST(Visibility, AutomaticLayersAreListsWhereThoseAreNoLargerThanThree) {
  VisibilityOptions o = method(VisibilityMethod::DeepOpacity);
  o.layers = 0;
  const LightView view = squareView(32);
  const StrandSet thin = wavyStrands(20, 0.002f), dense = wavyStrands(6000, 0.002f);
  const Map lists = build(thin, view, o), truth = build(thin, view, method(VisibilityMethod::Exact));
  EXPECT_EQ(lists->method(), VisibilityMethod::Exact);
  EXPECT_EQ(meanError(*lists, *truth), 0);
  EXPECT_LE(lists->bytesPerTexel(), 16);
  EXPECT_EQ(build(dense, view, o)->method(), VisibilityMethod::DeepOpacity);
  o.leaveOut = false;
  const Map layers = build(thin, view, o);
  EXPECT_EQ(layers->method(), VisibilityMethod::DeepOpacity);
  EXPECT_GE(layers->options().layers, 3);
}

TEST(Visibility, AutomaticLayersStopWhereNoMoreIsGained) {
  // Every fragment takes half of the light: no layer can take less, however many there are.
  VisibilityOptions o = method(VisibilityMethod::DeepOpacity);
  o.layers = 0, o.bound = 0.01, o.leaveOut = false;
  EXPECT_LE(build(column(spread(0.2, 0.8, 4), 0.5), squareView(4), o)->options().layers, 31);
}

TEST(Visibility, LayerEndsFollowTheirLaws) {
  EXPECT_EQ(deepLayerEnds(LayerSizes::Constant, 4, 2), (std::vector<double>{2, 4, 6, 8}));
  EXPECT_EQ(deepLayerEnds(LayerSizes::Linear, 4, 2), (std::vector<double>{2, 6, 12, 20}));
  EXPECT_EQ(deepLayerEnds(LayerSizes::PowersOfTwo, 4, 2), (std::vector<double>{2, 6, 14, 30}));
  EXPECT_EQ(deepLayerEnds(LayerSizes::Fibonacci, 6, 1), (std::vector<double>{1, 3, 6, 11, 19, 32}));
  const auto many = deepLayerEnds(LayerSizes::PowersOfTwo, 255, 1);
  for (const double end : many) EXPECT_TRUE(std::isfinite(end));
}

TEST(Visibility, RulesPastTheLastLayer) {
  const StrandSet set = column({0.1, 0.12, 0.9}, 0.5);
  VisibilityOptions o = method(VisibilityMethod::DeepOpacity);
  o.sizes = LayerSizes::Constant, o.layers = 2, o.layerSize = 0.05;
  const auto at = [&](PastLastLayer past, double depth) {
    o.past = past;
    return build(set, squareView(4), o)->transmittance(inColumn(depth));
  };
  EXPECT_NEAR(at(PastLastLayer::Ignore, 0.95), 0.25, 1e-6);
  EXPECT_NEAR(at(PastLastLayer::AddToLast, 0.95), 0.125, 1e-6);
  EXPECT_NEAR(at(PastLastLayer::AddToLast, 0.5), 0.125, 1e-6);  // shadowed by what is behind it
  EXPECT_NEAR(at(PastLastLayer::EnlargeLast, 0.95), 0.125, 1e-6);
  // From 0.05 behind the first fragment to the last one, 0.8 behind it, one fragment's depth is spread.
  EXPECT_NEAR(at(PastLastLayer::EnlargeLast, 0.5), std::pow(0.5, 2 + 0.35 / 0.75), 1e-5);
}

TEST(Visibility, ClusterBinsNeverTurnInsideOut) {
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const CounterRandom random(17, i);
    std::vector<float> means, deviations;
    double at = 0;
    for (std::uint64_t j = 0; j < 5; ++j) {
      at += 0.2 * random.uniform(3 * j);
      means.push_back(random.uniform(3 * j + 1) < 0.2 ? NAN : float(at));
      deviations.push_back(float(0.3 * random.uniform(3 * j + 2)));  // far more than the means are apart
    }
    std::vector<ClusterBin> bins(5);
    clusterBins(means, deviations, bins);
    float before = 0;
    for (std::size_t j = 0; j < 5; ++j) {
      if (std::isnan(means[j])) continue;
      EXPECT_LE(before, bins[j].from);
      EXPECT_LE(bins[j].from, means[j]);
      EXPECT_LE(means[j], bins[j].to);
      before = bins[j].to;
    }
    EXPECT_LE(before, 1);
  }
}

TEST(Visibility, FurtherChannelsAreSummedLikeTheOpticalDepth) {
  const StrandSet set = wavyStrands(600, 0.004f);
  const LightView view = squareView(16);
  const FragmentStream stream = FragmentStream::make(set, view).value();
  ChannelSource source{2, [](const Fragment& f, std::span<float> out) {
                         out[0] = -3 * f.beta();
                         out[1] = 1;
                       }};
  for (const VisibilityMethod m : kMapped) {
    const auto map = buildVisibility(stream, method(m), source);
    const auto alone = buildVisibility(stream, method(m));
    ASSERT_TRUE(map.ok() && alone.ok());
    for (std::uint64_t i = 0; i < 100; ++i) {
      const CounterRandom random(19, i);
      const Vec3 p(random.uniform(0), random.uniform(1), random.uniform(2));
      std::array<float, 3> out{};
      (*map)->sums(p, out);
      EXPECT_FLOAT_EQ(out[0], float((*alone)->opticalDepth(p))) << name(m);
      EXPECT_NEAR(out[1], -3 * out[0], 1e-4 * (1 + out[0])) << name(m);
      EXPECT_GE(out[2], 0) << name(m);
    }
    EXPECT_GT((*map)->bytesPerTexel(), (*alone)->bytesPerTexel());
  }
}

TEST(Visibility, FilterMixesTransmittanceAndNeverDepth) {
  // Hair in texel (1, 1) alone: halfway to an empty neighbour, half the light comes through unhindered.
  const StrandSet set = column({0.5}, 0.6);
  for (const VisibilityMethod m : kMapped) {
    VisibilityOptions o = method(m);
    o.filter = true;
    const Map map = build(set, squareView(4), o);
    EXPECT_NEAR(map->transmittance(Vec3(0.375, 0.375, 0.1)), 0.4, 1e-6) << name(m);
    EXPECT_NEAR(map->transmittance(Vec3(0.5, 0.375, 0.1)), 0.7, 1e-6) << name(m);
    EXPECT_NEAR(map->transmittance(Vec3(0.5, 0.5, 0.1)), 0.85, 1e-6) << name(m);
    EXPECT_DOUBLE_EQ(map->transmittance(Vec3(0.5, 0.375, 0.6)), 1) << name(m);
  }
}

TEST(Visibility, OpaqueSurfaceStopsTheLight) {
  PolygonMesh mesh;
  mesh.positions = {Vec3(0, 0, 0.3), Vec3(1, 0, 0.3), Vec3(1, 1, 0.3), Vec3(0, 1, 0.3)};
  mesh.addFace(std::vector<std::uint32_t>{0, 1, 2, 3});
  const OpaqueMap opaque = OpaqueMap::make(mesh, squareView(4)).value();
  const StrandSet set = column({0.5}, 0.5);
  for (const VisibilityMethod m : {VisibilityMethod::None, VisibilityMethod::DeepOpacity}) {
    VisibilityOptions o = method(m);
    o.opaque = &opaque;
    const Map map = build(set, squareView(4), o);
    EXPECT_EQ(map->transmittance(inColumn(0.8)), 0);
    EXPECT_NEAR(map->transmittance(inColumn(0.6)), m == VisibilityMethod::None ? 1 : 0.5, 1e-6);
  }
}

/// Every query of every method is a number in [0, 1] that falls with depth.
void expectSane(const StrandSet& set, const LightView& view, const std::string& what) {
  for (const VisibilityMethod m : kMapped) {
    VisibilityOptions o = method(m);
    o.filter = view.perspective;
    const Map map = build(set, view, o);
    EXPECT_TRUE(std::isfinite(map->aPosterioriBound().mean)) << what;
    for (const double x : {-1.0, 0.3751, 0.5, 0.99}) {
      double before = 1;
      for (int i = 0; i <= 40; ++i) {
        const double t = map->transmittance(Vec3(x, 0.376, 1 - i / 40.0));
        EXPECT_TRUE(t >= 0 && t <= 1) << what << ' ' << name(m);
        if (!view.perspective) {
          EXPECT_LE(t, before + 1e-12) << what << ' ' << name(m);
        }
        before = t;
      }
    }
    const Vec3 nowhere(NAN, 0, HUGE_VAL);
    EXPECT_EQ(map->transmittance(nowhere), 1) << what << ' ' << name(m);
  }
}

TEST(Visibility, ExtremesGiveNumbers) {
  const LightView view = squareView(4);
  expectSane(StrandSet{}, view, "no strand");
  expectSane(column({0.5}, 0.5), view, "one strand");
  expectSane(column(spread(0, 1, 3000), 0.9), view, "all strands in one texel");
  expectSane(column({0.2, 0.4}, 1), view, "alpha 1");
  expectSane(column({0.2, 0.4}, 1e-6), view, "alpha 1e-6");
  expectSane(column({0.4, 0.4, 0.4}, 0.5), view, "far equals near");
  expectSane(column({0.2}, 0), view, "zero width");
  StrandSet broken = column({0.2}, 0.3);
  broken.points[0].x() = NAN;
  expectSane(broken, view, "a strand that is no number");
  const StrandSet cloud = wavyStrands(300, 0.01f);
  expectSane(cloud, pointLightView(Vec3(0.5, 0.5, 0.5), {Vec3::Zero(), Vec3::Ones()}, 16),
             "light in the hair");
  expectSane(cloud, pointLightView(Vec3(0.5, 0.5, 1.4), {Vec3::Zero(), Vec3::Ones()}, 16),
             "light near the hair");
  LightView one = squareView(1);
  expectSane(cloud, one, "a single texel");
}

TEST(Visibility, SmallAlphaKeepsItsOpticalDepth) {
  const StrandSet set = column(spread(0.2, 0.8, 100), 1e-6);
  for (const VisibilityMethod m : kMapped) {
    const Map map = build(set, squareView(4), method(m));
    EXPECT_NEAR(1 - map->transmittance(inColumn(0.9)), 1e-4, 1e-8) << name(m);
  }
}

TEST(Visibility, SameBytesForAnyNumberOfThreads) {
  const StrandSet set = wavyStrands(9000, 0.002f);
  const LightView view = squareView(40);
  for (const VisibilityMethod m : kMapped) {
    const Map one = build(set, view, method(m), 1), more = build(set, view, method(m), 4);
    for (std::uint64_t i = 0; i < 500; ++i) {
      const CounterRandom random(23, i);
      const Vec3 p(random.uniform(0), random.uniform(1), random.uniform(2));
      ASSERT_EQ(one->opticalDepth(p), more->opticalDepth(p)) << name(m);
    }
    EXPECT_EQ(one->aPosterioriBound().mean, more->aPosterioriBound().mean) << name(m);
  }
}

TEST(Visibility, BytesPerTexelAreThoseOfThePapers) {
  const StrandSet set = column({0.5}, 0.5);
  const auto bytes = [&](VisibilityOptions o) { return build(set, squareView(4), o)->bytesPerTexel(); };
  VisibilityOptions o = method(VisibilityMethod::DeepOpacity);
  for (const auto& [layers, expected] : {std::pair{3, 16}, {7, 32}, {15, 64}}) {
    o.layers = layers;
    EXPECT_EQ(bytes(o), expected);
  }
  EXPECT_EQ(bytes(method(VisibilityMethod::Opacity)), 512);
  EXPECT_EQ(bytes(method(VisibilityMethod::Occupancy)), 40);
  EXPECT_EQ(bytes(method(VisibilityMethod::DensityClustering)), 48);
  EXPECT_EQ(bytes(method(VisibilityMethod::None)), 0);
}

TEST(Visibility, OptionsOutOfRangeAreRefused) {
  const StrandSet set = column({0.5}, 0.5);
  const FragmentStream stream = FragmentStream::make(set, squareView(4)).value();
  std::vector<VisibilityOptions> bad(7);
  bad[0].slices = 0;
  bad[1].clusters = 17;
  bad[2].layers = -1;
  bad[3].layerSize = NAN;
  bad[4].occupancySlices = 96;
  bad[5].slabs = 0;
  bad[6].bound = 0;
  for (const VisibilityOptions& o : bad) {
    const auto map = buildVisibility(stream, o);
    ASSERT_FALSE(map.ok());
    EXPECT_EQ(map.error().code, ErrorCode::InvalidArgument);
  }
  EXPECT_FALSE(buildVisibility(stream, {}, {16, [](const Fragment&, std::span<float>) {}}).ok());
}

TEST(Visibility, CancelledBuildsSaySo) {
  const std::atomic<bool> cancel{true};
  Context context;
  context.cancel = &cancel;
  const StrandSet set = column({0.5}, 0.5);
  const auto stream = FragmentStream::make(set, squareView(4), {}, context);
  ASSERT_FALSE(stream.ok());
  EXPECT_EQ(stream.error().code, ErrorCode::Cancelled);
}

}  // namespace
}  // namespace coif
