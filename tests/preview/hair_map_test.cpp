// The GPU's shadow maps against light's on the CPU: same strands, same view, same places.
#include "preview/hair_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "coif/base/random.h"
#include "preview/context_egl.h"
#include "preview/passes.h"

namespace coif::preview {
namespace {

constexpr double kWidth = 0.004;

// Clumps of wavy hairs in a box of about one, none of them in line with the map's texels.
StrandSet clumps(std::size_t count, float width = float(kWidth)) {
  StrandSet strands;
  for (std::size_t s = 0; s < count; ++s) {
    const CounterRandom clump(11, s / 25), own(12, s);
    const Vec3 root = Vec3(clump.uniform(0), clump.uniform(1), clump.uniform(2)) +
                      0.08 * Vec3(own.uniform(0), own.uniform(1), own.uniform(2));
    const Vec3 lean(clump.uniform(3) - 0.5, clump.uniform(4) - 0.5, clump.uniform(5) - 0.5);
    for (int i = 0; i < 16; ++i) {
      const double t = i / 15.0;
      const Vec3 wave(0.03 * std::sin(7 * t + clump.uniform(6) * 6), 0.02 * std::cos(9 * t), 0);
      strands.points.push_back((root + 0.6 * t * lean + wave).cast<float>());
      strands.widths.push_back(width * float(1 - 0.5 * t));
    }
    strands.offsets.push_back(strands.points.size());
  }
  return strands;
}

Box boxOf(const StrandSet& strands) {
  std::vector<Vec3> points;
  for (const Vec3f& p : strands.points) points.push_back(p.cast<double>());
  return bounds(points);
}

struct OnGpu {
  std::unique_ptr<HairModel> model;
  std::unique_ptr<HairBuffers> hair;
  std::unique_ptr<StrandBuffers> lines;
};

class HairMaps : public ::testing::Test {
 protected:
  void SetUp() override {
    auto made = EglContext::create();
    if (!made.ok()) GTEST_SKIP() << made.error().text();
    gl = std::move(*made);
    ASSERT_TRUE(gl->makeCurrent().ok());
    programs = std::make_unique<Programs>(allPermutations());
  }
  void TearDown() override {
    if (gl == nullptr) return;
    programs.reset();
    EXPECT_TRUE(gl->log().errors.empty()) << gl->log().errors.front();
    gl->release();
  }
  OnGpu upload(const StrandSet& strands) {
    OnGpu gpu;
    PreparedHair hair = prepareImported(strands, 1u << 24, {}).value();
    gpu.model = std::make_unique<HairModel>(std::move(hair.model));
    gpu.hair = std::make_unique<HairBuffers>(*gpu.model, hair.upload);
    DetailOptions everything;
    everything.lod = false;
    DetailPlan plan = makePlan(*gpu.model, everything, [](const Vec3&) { return 1.0; }, {});
    gpu.lines = std::make_unique<StrandBuffers>(*gpu.model, *gpu.hair, *programs, std::move(plan),
                                                Topology::Segments);
    return gpu;
  }
  struct Difference {
    double mean = 0, meanAbsolute = 0, cpuMean = 0;
  };
  // At the middles of the strands' segments, and anywhere in the box.
  Difference compare(const StrandSet& strands, const LightView& view, const VisibilityOptions& options,
                     double opacity = 1) {
    const OnGpu gpu = upload(strands);
    FragmentOptions fragments;
    fragments.opacity = opacity;
    const FragmentStream stream = FragmentStream::make(strands, view, fragments).value();
    const auto cpu = buildVisibility(stream, options).value();
    auto made = HairMap::make(*programs, gpu.lines.get(), view, opacity, cpu->options());
    if (!made.ok()) {
      ADD_FAILURE() << made.error().text();
      return {};
    }
    std::vector<Vec3> points;
    const CounterRandom random(3, 0);
    const Box box = boxOf(strands);
    for (std::size_t i = 0; i < 8000; ++i) {
      const std::size_t s = std::size_t(random.uniform(4 * i) * double(strands.strandCount()));
      const auto strand = strands.strand(s);
      const std::size_t k = std::size_t(random.uniform(4 * i + 1) * double(strand.size() - 1));
      points.push_back(0.5 * (strand[k] + strand[k + 1]).cast<double>());
      points.push_back(box.lo +
                       Vec3(random.uniform(4 * i + 1), random.uniform(4 * i + 2), random.uniform(4 * i + 3))
                           .cwiseProduct(box.hi - box.lo));
    }
    const auto answers = made->query(*programs, points);
    Difference result;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double t = cpu->transmittance(points[i]), n = double(points.size());
      EXPECT_TRUE(std::isfinite(answers[i].transmittance) && std::isfinite(answers[i].opticalDepth));
      result.mean += (double(answers[i].transmittance) - t) / n;
      result.meanAbsolute += std::abs(double(answers[i].transmittance) - t) / n;
      result.cpuMean += t / n;
    }
    return result;
  }

  std::unique_ptr<EglContext> gl;
  std::unique_ptr<Programs> programs;
};

struct Case {
  const char* name;
  VisibilityOptions options;
};

std::vector<Case> everyMethod() {
  std::vector<Case> cases;
  const auto add = [&](const char* name, auto change) {
    VisibilityOptions options;
    options.layerSize = 0.05;
    change(options);
    cases.push_back({name, options});
  };
  using O = VisibilityOptions;
  add("none", [](O& o) { o.method = VisibilityMethod::None; });
  add("exact", [](O& o) { o.method = VisibilityMethod::Exact; });
  for (const int slices : {8, 16, 100, 256}) {
    add("opacity", [=](O& o) { o.method = VisibilityMethod::Opacity, o.slices = slices; });
  }
  add("clustering", [](O& o) { o.method = VisibilityMethod::DensityClustering; });
  add("occupancy", [](O& o) { o.method = VisibilityMethod::Occupancy; });
  for (const int layers : {1, 3, 7, 11, 15}) add("deep", [=](O& o) { o.layers = layers; });
  for (const LayerSizes law : {LayerSizes::Constant, LayerSizes::PowersOfTwo, LayerSizes::Fibonacci}) {
    for (const PastLastLayer past :
         {PastLastLayer::Ignore, PastLastLayer::AddToLast, PastLastLayer::EnlargeLast}) {
      add("deep", [=](O& o) { o.layers = 5, o.sizes = law, o.past = past, o.layerSize = 0.02; });
    }
  }
  return cases;
}

TEST_F(HairMaps, AgreeWithTheCpuForEveryMethod) {
  const StrandSet strands = clumps(1200);
  const Box box = boxOf(strands);
  const LightView view = distantLightView(Vec3(0.3, 0.8, 0.45), box, 128);
  for (Case test : everyMethod()) {
    for (const bool filter : {false, true}) {
      test.options.filter = filter;
      const Difference d = compare(strands, view, test.options);
      // Floats against doubles: a fragment at a texel's border may fall to either side.
      EXPECT_LT(std::abs(d.mean), 1e-3) << test.name;
      EXPECT_LT(d.meanAbsolute, 2e-3) << test.name;
      EXPECT_TRUE(test.options.method == VisibilityMethod::None || d.cpuMean < 0.9) << test.name;
    }
  }
}

// Nearly opaque and nearly invisible hair, a light amid the hair, hair far longer than the map, all strands in one
// texel, no width.
TEST_F(HairMaps, AgreeWithTheCpuAtExtremes) {
  const StrandSet usual = clumps(300), wide = clumps(300, 9), none = clumps(20, 0);
  StrandSet bundle;
  for (int i = 0; i < 300; ++i) {
    bundle.points.insert(bundle.points.end(), {Vec3f(0.1f, 0.1f, 0), Vec3f(0.1001f, 0.1f, 0.5f), Vec3f(0.1f, 0.1003f, 1)});
    bundle.widths.resize(bundle.points.size(), 0.02f);
    bundle.offsets.push_back(bundle.points.size());
  }
  const Box box = boxOf(usual), corner{box.lo, box.lo + 0.2 * (box.hi - box.lo)};
  const Vec3 middle = 0.5 * (box.lo + box.hi);
  const Vec3 oblique(0.3, 0.8, 0.45);
  struct Extreme {
    const char* name;
    const StrandSet* strands;
    LightView view;
    double opacity;
  };
  const Extreme extremes[] = {{"opaque", &wide, distantLightView(oblique, box, 128), 1},
                              {"invisible", &usual, distantLightView(oblique, box, 128), 1e-6},
                              {"a light in the hair", &usual, pointLightView(middle, box, 128), 1},
                              {"hair beyond the map", &usual, distantLightView(oblique, corner, 128), 1},
                              {"one texel", &bundle, distantLightView(Vec3(0.001, 0, 1), box, 64), 1},
                              {"no width", &none, distantLightView(oblique, box, 64), 1}};
  for (const Extreme& extreme : extremes) {
    for (const Case& test : everyMethod()) {
      const Difference d = compare(*extreme.strands, extreme.view, test.options, extreme.opacity);
      // As above; fewer hairs, so that one that falls to the texel beside weighs more.
      EXPECT_LT(std::abs(d.mean), 1e-3) << extreme.name << ", " << test.name;
      EXPECT_LT(d.meanAbsolute, 4e-3) << extreme.name << ", " << test.name;
    }
  }
}

TEST_F(HairMaps, KnowTheirBoundAsTheCpuDoes) {
  const StrandSet strands = clumps(800);
  const LightView view = distantLightView(Vec3(0.3, 0.8, 0.45), boxOf(strands), 100);
  const OnGpu gpu = upload(strands);
  const FragmentStream stream = FragmentStream::make(strands, view, {}).value();
  for (const int layers : {3, 7, 15}) {
    VisibilityOptions options;
    options.layers = layers, options.layerSize = 0.02;
    const TransmittanceBound cpu = buildVisibility(stream, options).value()->aPosterioriBound();
    const auto map = HairMap::make(*programs, gpu.lines.get(), view, 1, options);
    ASSERT_TRUE(map.ok()) << map.error().text();
    const TransmittanceBound bound = map->bound(*programs);
    EXPECT_GT(cpu.mean, 0.01) << layers;
    // Floats against doubles, and a fragment at a texel's border may fall to either side.
    EXPECT_NEAR(bound.mean, cpu.mean, 1e-3) << layers;
    EXPECT_NEAR(bound.worst, cpu.worst, 1e-2) << layers;
  }
}

TEST_F(HairMaps, TakeTheFewestLayersThatMeetTheBound) {
  const StrandSet strands = clumps(1200);
  const LightView view = distantLightView(Vec3(0.3, 0.8, 0.45), boxOf(strands), 64);
  const OnGpu gpu = upload(strands);
  VisibilityOptions options;
  options.layerSize = 0.02;
  std::vector<double> bounds;
  for (const int layers : {3, 7, 11, 15}) {
    options.layers = layers;
    bounds.push_back(HairMap::make(*programs, gpu.lines.get(), view, 1, options)->bound(*programs).mean);
  }
  ASSERT_LT(bounds[1], 0.97 * bounds[0]) << "or the test could not tell them apart";
  ASSERT_LT(bounds[2], 0.97 * bounds[1]);
  options.layers = 0;
  const auto fewest = [&](double bound) {
    options.bound = bound;
    return HairMap::makeFewest(*programs, *gpu.lines, view, 1, options, false, {}).value();
  };
  EXPECT_EQ(fewest(1.001 * bounds[0]).options().layers, 3);
  EXPECT_EQ(fewest(0.999 * bounds[0]).options().layers, 7);
  EXPECT_EQ(fewest(1.001 * bounds[2]).options().layers, 11);
  const HairMap impossible = fewest(1e-9);
  EXPECT_LE(impossible.bound(*programs).mean, 1.03 * *std::ranges::min_element(bounds));
  EXPECT_NE(impossible.choice().find("layers: bound"), std::string::npos) << impossible.choice();
}

TEST_F(HairMaps, SortShortListsInsteadOfLayering) {
  const StrandSet few = clumps(30), many = clumps(4000);
  for (const StrandSet* strands : {&few, &many}) {
    const LightView view = distantLightView(Vec3(0.3, 0.8, 0.45), boxOf(*strands), 64);
    const OnGpu gpu = upload(*strands);
    VisibilityOptions options;
    options.layers = 0, options.layerSize = 0.02;
    const HairMap map = HairMap::makeFewest(*programs, *gpu.lines, view, 1, options, true, {}).value();
    EXPECT_EQ(map.options().method,
              strands == &few ? VisibilityMethod::Exact : VisibilityMethod::DeepOpacity);
    // Never more than three layers and the lists' own table.
    if (strands == &few) {
      EXPECT_LE(map.bytes(), 64u * 64u * (24 + 8) + 4);
    }
    const HairMap layered = HairMap::makeFewest(*programs, *gpu.lines, view, 1, options, false, {}).value();
    EXPECT_EQ(layered.options().method, VisibilityMethod::DeepOpacity) << "the switch is off";
  }
}

}  // namespace
}  // namespace coif::preview
