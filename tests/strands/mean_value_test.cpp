#include "coif/strands/mean_value.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>

#include "coif/base/random.h"

__extension__ typedef __float128 Quad;
template <>
struct coif::MeanValueMath<Quad> {
  static Quad sqrt(Quad value) {  // two Newton steps from the long double root: 64 -> 128 bits
    if (!(value > 0)) return 0;
    Quad root = std::sqrt(static_cast<long double>(value));
    for (int step = 0; step < 2; ++step) root = (root + value / root) / 2;
    return root;
  }
  static bool isFinite(Quad value) { return value - value == 0; }
};

namespace coif {
namespace {

struct ReferenceCase {
  std::string name;
  std::vector<Vec2> polygon;
  Vec2 point;
  std::vector<double> weights;
};

std::vector<ReferenceCase> referenceCases() {
  std::ifstream file(COIF_SHARED_DATA "/reference_values/mean_value_coordinates.json");
  if (!file) return {};
  const auto document = nlohmann::json::parse(file);
  std::vector<ReferenceCase> cases;
  for (const auto& entry : document["cases"]) {
    ReferenceCase one;
    one.name = entry["poly"].get<std::string>();
    one.point = Vec2(entry["x"][0].get<double>(), entry["x"][1].get<double>());
    one.weights = entry["w"].get<std::vector<double>>();
    for (const auto& corner : document["polygons"][one.name]) {
      one.polygon.emplace_back(corner[0].get<double>(), corner[1].get<double>());
    }
    cases.push_back(std::move(one));
  }
  return cases;
}

template <class T>
std::vector<T> weightsAs(const std::vector<Vec2>& polygon, const Vec2& point) {
  std::vector<T> xy, out(polygon.size());
  for (const Vec2& corner : polygon) xy.insert(xy.end(), {T(corner.x()), T(corner.y())});
  meanValueWeights<T>(xy.data(), polygon.size(), T(point.x()), T(point.y()), out.data());
  return out;
}

std::vector<Vec2> regular(std::size_t n, double radius = 1, Vec2 centre = Vec2::Zero()) {
  std::vector<Vec2> polygon;
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * double(i) / double(n);
    polygon.push_back(centre + radius * Vec2(std::cos(angle), std::sin(angle)));
  }
  return polygon;
}

const std::vector<Vec2> kLShape{{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}};

// Error: max over corners of |λ − reference|, both dimensionless. The references are 50-digit values of the
// points as doubles; the float column also pays for rounding points and polygons to float.
TEST(MeanValue, MatchesFiftyDigitReferences) {
  const auto cases = referenceCases();
  if (cases.empty()) GTEST_SKIP() << "no reference values at " COIF_SHARED_DATA;
  EXPECT_EQ(cases.size(), 130u);
  double worstDouble = 0, worstFloat = 0;
  for (const ReferenceCase& one : cases) {
    std::vector<double> out(one.polygon.size());
    meanValueCoordinates(one.polygon, one.point, out);
    std::vector<Vec2f> polygonF;
    for (const Vec2& corner : one.polygon) polygonF.push_back(corner.cast<float>());
    std::vector<float> outF(out.size());
    meanValueCoordinates(polygonF, Vec2f(one.point.cast<float>()), outF);
    for (std::size_t i = 0; i < out.size(); ++i) {
      EXPECT_NEAR(out[i], one.weights[i], 1e-13) << one.name;
      EXPECT_NEAR(outF[i], one.weights[i], 1e-6) << one.name << " in float";
      worstDouble = std::max(worstDouble, std::abs(out[i] - one.weights[i]));
      worstFloat = std::max(worstFloat, std::abs(double(outF[i]) - one.weights[i]));
    }
  }
  std::cout << "worst error: " << worstDouble << " double, " << worstFloat << " float\n";
}

// The same bound against 113-bit arithmetic, and linear precision to 1e-12 of the diameter: distances to the
// edge from 1e-1 to 1e-15, sizes from 1e-30 to 1e30, far from the origin only as far as the input itself is
// exact.
TEST(MeanValue, StaysAccurateNextToEdgesAtAnySize) {
  const CounterRandom random(7);
  std::uint64_t counter = 0;
  for (const auto& base : {regular(3), regular(4), regular(7), regular(40), kLShape}) {
    for (const double size : {1e-30, 1.0, 1e30}) {
      std::vector<Vec2> polygon = base;
      for (Vec2& corner : polygon) corner *= size;
      for (int digits = 1; digits <= 15; ++digits) {
        const std::size_t i = random.below(counter++, std::uint32_t(polygon.size()));
        const Vec2 a = polygon[i], edge = polygon[(i + 1) % polygon.size()] - a;
        const Vec2 point = a + (0.1 + 0.8 * random.uniform(counter++)) * edge +
                           std::pow(10.0, -digits) * Vec2(-edge.y(), edge.x()) * 0.3;
        const auto truth = weightsAs<Quad>(polygon, point);
        const auto found = weightsAs<double>(polygon, point);
        Vec2 sum = Vec2::Zero();
        double total = 0;
        for (std::size_t k = 0; k < found.size(); ++k) {
          EXPECT_NEAR(found[k], double(truth[k]), 1e-13)
              << "corner " << k << ", size " << size << ", 1e-" << digits;
          sum += found[k] * polygon[k];
          total += found[k];
        }
        EXPECT_NEAR(total, 1, 1e-15 * double(found.size()));  // one rounding a corner
        EXPECT_LE((sum - point).norm(), 1e-12 * size);
      }
    }
  }
}

TEST(MeanValue, ReproducesLinearFunctionsAndOne) {
  const CounterRandom random(11);
  for (std::uint64_t i = 0; i < 500; ++i) {
    const auto polygon = regular(3 + i % 9, 5, {100, -40});
    const double radius = 5 * 0.5 * random.uniform(2 * i), angle = 6.28 * random.uniform(2 * i + 1);
    const Vec2 point = Vec2(100, -40) + radius * Vec2(std::cos(angle), std::sin(angle));
    std::vector<double> out(polygon.size());
    EXPECT_EQ(meanValueCoordinates(polygon, point, out), MeanValueCase::General);
    Vec2 sum = Vec2::Zero();
    double total = 0;
    for (std::size_t k = 0; k < out.size(); ++k) sum += out[k] * polygon[k], total += out[k];
    EXPECT_LE((sum - point).norm(), 1e-12 * 10);  // of the diameter
    EXPECT_NEAR(total, 1, 1e-14);
  }
}

TEST(MeanValue, IsExactOnCornersAndEdges) {
  const std::vector<Vec2> square{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  std::vector<double> out(4);
  EXPECT_EQ(meanValueCoordinates(square, Vec2(1, 1), out), MeanValueCase::Corner);
  EXPECT_EQ(out, (std::vector<double>{0, 0, 1, 0}));
  EXPECT_EQ(meanValueCoordinates(square, Vec2(0, 1), out), MeanValueCase::Corner);
  EXPECT_EQ(out, (std::vector<double>{0, 0, 0, 1}));
  EXPECT_EQ(meanValueCoordinates(square, Vec2(0, 0.25), out), MeanValueCase::Edge);
  EXPECT_EQ(out, (std::vector<double>{0.75, 0, 0, 0.25}));
}

TEST(MeanValue, KeepsNegativeWeightsOfConcavePolygons) {
  // Inside any quadrilateral they are positive (Hormann and Floater 2006), so a U: its far arm sees backs of
  // edges.
  const std::vector<Vec2> u{{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}};
  std::vector<double> out(u.size());
  const Vec2 point(0.5, 2.8);
  meanValueCoordinates(u, point, out);
  EXPECT_LT(*std::min_element(out.begin(), out.end()), -1e-3);
  Vec2 sum = Vec2::Zero();
  for (std::size_t k = 0; k < u.size(); ++k) sum += out[k] * u[k];
  EXPECT_LE((sum - point).norm(), 1e-14);
}

TEST(MeanValue, DoesNotDependOnTheDirectionOrThePlane) {
  const Mat3 turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, -2).normalized()).toRotationMatrix();
  for (const auto& polygon : {regular(5), kLShape}) {
    const Vec2 point(0.3, 0.2);
    std::vector<double> flat(polygon.size()), turned(polygon.size()), back(polygon.size());
    meanValueCoordinates(polygon, point, flat);
    std::vector<Vec3> space;
    for (const Vec2& corner : polygon)
      space.push_back(turn * Vec3(corner.x(), corner.y(), 0) + Vec3(3, 4, 5));
    meanValueCoordinates(space, Vec3(turn * Vec3(point.x(), point.y(), 0) + Vec3(3, 4, 5)), turned);
    const std::vector<Vec2> reversed(polygon.rbegin(), polygon.rend());
    meanValueCoordinates(reversed, point, back);
    for (std::size_t k = 0; k < flat.size(); ++k) {
      EXPECT_NEAR(turned[k], flat[k], 2e-14);  // the rotation rounds coordinates of size 8 by 1e-15
      EXPECT_NEAR(back[flat.size() - 1 - k], flat[k], 1e-15);
    }
  }
}

TEST(MeanValue, SaysWhenAPolygonHasNoExtent) {
  const std::vector<Vec2> dot(4, Vec2(2, 3));
  std::vector<double> out(4);
  EXPECT_EQ(meanValueCoordinates(dot, Vec2(2, 3), out), MeanValueCase::Degenerate);
  EXPECT_EQ(out, std::vector<double>(4, 0.25));
  const std::vector<Vec3> line{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}};
  out.resize(3);
  EXPECT_EQ(meanValueCoordinates(line, Vec3(1, 1, 1), out), MeanValueCase::Degenerate);
  for (const double weight : out) EXPECT_TRUE(std::isfinite(weight));
}

}  // namespace
}  // namespace coif
