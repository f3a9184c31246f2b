#include "coif/light/transparency.h"

#include <gtest/gtest.h>

#include "light/light_fixture.h"

namespace coif {
namespace {

using Method = TransparencyMethod;
constexpr Method kMethods[] = {Method::SortedList, Method::OccupancyOrdered, Method::WeightedAverage};

/// A colour of its own for every strand.
Vec3f strandColor(std::uint32_t point) {
  const CounterRandom random(31, point / 2);
  return Vec3f(float(random.uniform(0)), float(random.uniform(1)), float(random.uniform(2)));
}
Vec3f colorOf(const Fragment& f) {
  return strandColor(f.point);
}

HairPixels blend(const StrandSet& set, const LightView& view, TransparencyOptions options, int threads = 0,
                 const std::function<Vec3f(const Fragment&)>& color = colorOf) {
  Context context;
  context.threads = threads;
  const FragmentStream stream = FragmentStream::make(set, view, {}, context).value();
  return blendHair(stream, color, options, context).value();
}

TransparencyOptions by(Method method, OrderNormalisation rule = OrderNormalisation::Corrected) {
  TransparencyOptions options;
  options.method = method;
  options.normalisation = rule;
  return options;
}

/// Mean over pixels and channels of |difference|, over a black background.
double meanError(const HairPixels& a, const HairPixels& b) {
  double sum = 0;
  for (std::size_t t = 0; t < a.color.size(); ++t) sum += double((a.color[t] - b.color[t]).cwiseAbs().mean());
  return sum / double(a.color.size());
}

TEST(Transparency, OneFragmentIsItsColourForEveryMethod) {
  StrandSet set;
  const LightView view = squareView(4);
  addAcross(set, view, 2, 1, 0.3, 0.25);
  for (const Method m : kMethods) {
    const HairPixels p = blend(set, view, by(m));
    EXPECT_NEAR(p.alpha[6], 0.25, 1e-6);
    EXPECT_LT((p.color[6] - 0.25f * strandColor(0)).norm(), 1e-6);
    EXPECT_EQ(p.alpha[5], 0);
    EXPECT_EQ(p.color[5], Vec3f::Zero());
  }
}

TEST(Transparency, SortedListIsFrontToBackComposition) {
  StrandSet set;
  const LightView view = squareView(4);
  addAcross(set, view, 1, 1, 0.75, 0.5);
  addAcross(set, view, 1, 1, 0.25, 0.4);  // drawn later, nearer
  const HairPixels p = blend(set, view, by(Method::SortedList));
  const Vec3f expected = 0.4f * strandColor(2) + 0.6f * 0.5f * strandColor(0);
  EXPECT_LT((p.color[5] - expected).norm(), 1e-6);
  EXPECT_NEAR(p.alpha[5], 0.7, 1e-6);
}

TEST(Transparency, OpaqueHairHidesWhatIsBehind) {
  StrandSet set;
  const LightView view = squareView(4);
  addAcross(set, view, 1, 1, 0.2, 1);
  for (int i = 0; i < 20; ++i) addAcross(set, view, 1, 1, 0.5 + 0.01 * i, 0.5);
  const HairPixels truth = blend(set, view, by(Method::SortedList));
  EXPECT_LT((truth.color[5] - strandColor(0)).norm(), 1e-5);
  EXPECT_LT(meanError(blend(set, view, by(Method::OccupancyOrdered)), truth), 1e-5);
}

TEST(Transparency, HairOfOneColourIsRightWhateverTheOrder) {
  const StrandSet set = wavyStrands(2000, 0.004f);
  const LightView view = squareView(24);
  const auto grey = [](const Fragment&) { return Vec3f(0.5f, 0.5f, 0.5f); };
  const HairPixels truth = blend(set, view, by(Method::SortedList), 0, grey);
  const HairPixels ordered = blend(set, view, by(Method::OccupancyOrdered), 0, grey);
  EXPECT_LT(meanError(ordered, truth), 1e-6);  // that is what Λ / a is for
  // The mean's composition is not the composition's mean where α varies: hairs at an angle cover up to √2.
  EXPECT_LT(meanError(blend(set, view, by(Method::WeightedAverage), 0, grey), truth), 0.01);
  EXPECT_GT(
      meanError(blend(set, view, by(Method::OccupancyOrdered, OrderNormalisation::None), 0, grey), truth),
      1e-4);
}

/// Pixels of 20 to 100 fragments in a few clumps, α = 0.1; clumps have their colours.
struct Clumps {
  StrandSet set;
  std::vector<Vec3f> colors;  ///< by strand
};
Clumps clumps(const LightView& view) {
  Clumps out;
  for (int t = 0; t < view.size * view.size; ++t) {
    const CounterRandom random(41, std::uint64_t(t));
    const int count = 2 + int(random.below(0, 4));
    std::uint64_t drawn = 100;
    for (int c = 0; c < count; ++c) {
      const CounterRandom own = random.child(std::uint64_t(c));
      const double middle = 0.1 + 0.8 * own.uniform(0), spread = 0.005 + 0.05 * own.uniform(1);
      const Vec3f color(float(own.uniform(2)), float(own.uniform(3)), float(own.uniform(4)));
      for (int i = 0; i < 10 + int(own.below(5, 10)); ++i) {
        addAcross(out.set, view, t % view.size, t / view.size,
                  middle + spread * (random.uniform(drawn++) - 0.5), 0.1);
        out.colors.push_back(color);
      }
    }
  }
  return out;
}

TEST(Transparency, NormalisationByLambdaOverSumIsRightAndThePrintedOneWrong) {
  const LightView view = squareView(32);
  const Clumps hair = clumps(view);
  const auto color = [&](const Fragment& f) { return hair.colors[f.point / 2]; };
  const HairPixels truth = blend(hair.set, view, by(Method::SortedList), 0, color);
  const auto error = [&](OrderNormalisation rule) {
    return meanError(blend(hair.set, view, by(Method::OccupancyOrdered, rule), 0, color), truth);
  };
  const double none = error(OrderNormalisation::None), corrected = error(OrderNormalisation::Corrected);
  const double printed = error(OrderNormalisation::AsPrinted);
  const double average = meanError(blend(hair.set, view, by(Method::WeightedAverage), 0, color), truth);
  RecordProperty("none", std::to_string(none));
  RecordProperty("corrected", std::to_string(corrected));
  RecordProperty("printed", std::to_string(printed));
  RecordProperty("average", std::to_string(average));
  // Another set of clumps was measured at 0.074, 0.018 and 0.130: the order of the three is what is promised.
  EXPECT_LT(corrected, none);
  EXPECT_LT(none, printed);
  EXPECT_LT(corrected, 0.03);
  EXPECT_LT(corrected, average);
}

TEST(Transparency, OccupancyApproachesTheSortedListWithItsSlices) {
  const LightView view = squareView(24);
  const Clumps hair = clumps(view);
  const auto color = [&](const Fragment& f) { return hair.colors[f.point / 2]; };
  const HairPixels truth = blend(hair.set, view, by(Method::SortedList), 0, color);
  double before = 1;
  for (const auto& [slices, slabs] : {std::pair{128, 1}, {256, 4}, {1024, 32}}) {
    TransparencyOptions options = by(Method::OccupancyOrdered);
    options.occupancySlices = slices, options.slabs = slabs;
    const double error = meanError(blend(hair.set, view, options, 0, color), truth);
    EXPECT_LT(error, 0.8 * before);
    before = error;
  }
}

TEST(Transparency, SameBytesForAnyNumberOfThreads) {
  const StrandSet set = wavyStrands(3000, 0.01f);
  const LightView view = squareView(40);
  for (const Method m : kMethods) {
    const HairPixels one = blend(set, view, by(m), 1), more = blend(set, view, by(m), 4);
    EXPECT_TRUE(one.color == more.color && one.alpha == more.alpha);
    for (const float a : one.alpha) EXPECT_TRUE(a >= 0 && a <= 1);
  }
}

TEST(Transparency, BadOptionsAreRefused) {
  const StrandSet set = wavyStrands(3, 0.01f);
  const FragmentStream stream = FragmentStream::make(set, squareView(4)).value();
  EXPECT_FALSE(blendHair(stream, {}).ok());
  TransparencyOptions options = by(Method::OccupancyOrdered);
  options.slabs = 3;
  EXPECT_FALSE(blendHair(stream, colorOf, options).ok());
}

}  // namespace
}  // namespace coif
