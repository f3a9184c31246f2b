#include "coif/strands/roots.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <complex>
#include <numbers>
#include <numeric>

#include "coif/base/random.h"
#include "coif/strands/mean_value.h"
#include "coif/strands/root_face.h"
#include "sample_meshes.h"

namespace coif {
namespace {

using Points = std::vector<Vec2>;

Points rootsInPlane(const HairMesh& mesh, const RootSet& roots, std::size_t count) {
  Points out;
  for (std::size_t r = 0; r < count; ++r) {
    const auto face = mesh.bundles()[roots.bundles[r]].face(0);
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < face.size(); ++i)
      sum += double(roots.weightsOf(r)[i]) * mesh.position(face[i]);
    out.emplace_back(sum.x(), -sum.z());
  }
  return out;
}

/// Mean power |Σ e^(2πi f·x)|²/N over whole frequencies of the square of side `side` with |f| below `share`
/// of √N: white noise has 1, an evenly spread set 0. Whole frequencies leak nothing of the mean density.
double lowPower(const Points& points, double side, double share) {
  const double reach = share * std::sqrt(double(points.size()));
  const int last = int(reach), step = std::max(1, last / 10);
  double sum = 0;
  int terms = 0;
  for (int y = -last; y <= last; y += step) {
    for (int x = 0; x <= last; x += step) {
      if ((x == 0 && y == 0) || std::hypot(x, y) > std::max(reach, 1.0)) continue;
      std::complex<double> amplitude = 0;
      for (const Vec2& p : points)
        amplitude += std::polar(1.0, 2 * std::numbers::pi * (x * p.x() + y * p.y()) / side);
      sum += std::norm(amplitude) / double(points.size());
      ++terms;
    }
  }
  return sum / terms;
}

/// Distances to the nearest other point in units of the mean spacing, ascending.
std::vector<double> nearestDistances(const Points& points, double side) {
  std::vector<double> out;
  for (const Vec2& p : points) {
    double best = 1e30;
    for (const Vec2& q : points) {
      if (&p != &q) best = std::min(best, (p - q).squaredNorm());
    }
    out.push_back(std::sqrt(best) / (side / std::sqrt(double(points.size()))));
  }
  std::sort(out.begin(), out.end());
  return out;
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

Points white(std::size_t count, double side) {
  const CounterRandom random(123);
  Points out;
  for (std::size_t i = 0; i < count; ++i)
    out.emplace_back(side * random.uniform(2 * i), side * random.uniform(2 * i + 1));
  return out;
}

/// Mitchell's best candidate over the whole torus, the slow way: what a mesh of one seamless face could do.
Points bestCandidate(std::size_t count, double side) {
  const CounterRandom random(77);
  Points out;
  std::uint64_t counter = 0;
  while (out.size() < count) {
    Vec2 best = Vec2::Zero();
    double bestDistance = -1;
    for (int c = 0; c < 16; ++c, counter += 2) {
      const Vec2 p(side * random.uniform(counter), side * random.uniform(counter + 1));
      double distance = 1e30;
      for (const Vec2& q : out) {
        Vec2 d = (p - q).cwiseAbs();
        d = d.cwiseMin(Vec2::Constant(side) - d);
        distance = std::min(distance, d.squaredNorm());
      }
      if (distance > bestDistance) best = p, bestDistance = distance;
    }
    out.push_back(best);
  }
  return out;
}

// Measured over these prefixes: low-frequency power 0.05 … 0.29, mean nearest distance 0.65 … 0.81. White
// noise: 1 and 0.5 exactly in expectation (Poisson process); best candidate without faces: about 0.12 and
// 0.83.
TEST(Roots, EveryPrefixIsBlueNoise) {
  const HairMesh mesh = samples::grid(14, 14, 1);
  const RootSet roots = placeRoots(mesh, {.count = 16000}).value();
  for (const std::size_t count : {50, 100, 200, 400, 1000, 4000, 16000}) {
    const Points points = rootsInPlane(mesh, roots, count);
    const double low = lowPower(points, 14, 0.3), whiteLow = lowPower(white(count, 14), 14, 0.3);
    EXPECT_LT(low, 0.4) << count;
    EXPECT_LT(low, 0.6 * whiteLow) << count;
    if (count > 4000) continue;  // the plain search is quadratic
    const auto distances = nearestDistances(points, 14),
               whiteDistances = nearestDistances(white(count, 14), 14);
    EXPECT_GT(mean(distances), 0.6) << count;
    EXPECT_GT(distances[count / 20], 1.3 * whiteDistances[count / 20]) << count;  // the closest twentieth
  }
}

TEST(Roots, InsideOneFaceTheyAreAsGoodAsBestCandidate) {
  const HairMesh mesh = samples::grid(1, 1, 1);
  const RootSet roots = placeRoots(mesh, {.count = 2000}).value();
  for (const std::size_t count : {100, 500, 2000}) {
    const Points points = rootsInPlane(mesh, roots, count), best = bestCandidate(count, 1);
    EXPECT_LT(lowPower(points, 1, 0.3), 1.5 * lowPower(best, 1, 0.3)) << count;
    EXPECT_GT(mean(nearestDistances(points, 1)), 0.95 * mean(nearestDistances(best, 1))) << count;
    EXPECT_GT(nearestDistances(points, 1)[0], 0.5) << count;  // not one pair closer than half the spacing
  }
}

TEST(Roots, AreDistributedByAreaAndDensity) {
  HairMesh mesh = samples::grid(10, 1, 1);
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {  // columns of width 1, 3, 5, …
    const Vec3 p = mesh.position(v);
    mesh.setPosition(v, {p.x() * p.x(), p.y(), p.z()});
  }
  std::vector<double> density(10, 1.0);
  density[9] = 0.5;
  const RootSet roots = placeRoots(mesh, {.count = 9050, .density = density}).value();
  double total = 0;
  for (std::size_t b = 0; b < 10; ++b) total += (2 * double(b) + 1) * density[b];
  for (std::size_t b = 0; b < 10;
       ++b) {  // no face is more than one root off its share, the merge's key being linear
    const double share = 9050 * (2 * double(b) + 1) * density[b] / total;
    EXPECT_NEAR(double(roots.bundleStarts[b + 1] - roots.bundleStarts[b]), share, 2) << b;
  }
}

TEST(Roots, SeedsGiveOtherPlaces) {
  const HairMesh mesh = samples::grid(3, 3, 1);
  const RootSet a = placeRoots(mesh, {.count = 100, .seed = 1}).value(),
                b = placeRoots(mesh, {.count = 100, .seed = 2}).value();
  EXPECT_NE(a.weights, b.weights);
}

/// Σ λ v is the root's place on any face, and λ sums to one.
TEST(Roots, WeightsReproduceThePlaceOnAnyFace) {
  const std::vector<std::vector<Vec3>> faces{
      {{0, 0, 0}, {4, 0, 0}, {1, 0, -3}},
      {{0, 0, 0}, {3, 0, 0}, {3, 0, -1}, {1, 0, -1}, {1, 0, -3}, {0, 0, -3}},
      {{0, 0, 0}, {3, 0, 0}, {3, 0, -3}, {2, 0, -3}, {2, 0, -1}, {1, 0, -1}, {1, 0, -3}, {0, 0, -3}},
      {{0, 0, 0}, {100, 0, 0}, {100, 0, -0.1}, {0, 0, -0.1}},
      {{0, 0, 0}, {1, 0.3, 0}, {1, 0, -1}, {0, 0.3, -1}}};  // saddle
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const HairMesh mesh = samples::column(faces[f], 2);
    const RootSet roots = placeRoots(mesh, {.count = 500}).value();
    ASSERT_EQ(roots.size(), 500u);
    const RootFace face(faces[f]);
    EXPECT_EQ(roots.negativeWeights > 0, f == 1 || f == 2) << f;  // the two concave ones
    std::vector<double> weights(faces[f].size());
    for (std::size_t r = 0; r < roots.size(); ++r) {
      Vec3 sum = Vec3::Zero();
      double total = 0;
      for (std::size_t i = 0; i < faces[f].size(); ++i) {
        sum += double(roots.weightsOf(r)[i]) * faces[f][i];
        total += double(roots.weightsOf(r)[i]);
      }
      EXPECT_NEAR(total, 1, 1e-6);  // eight floats
      face.weights(face.project(sum), weights);
      for (std::size_t i = 0; i < weights.size(); ++i) {
        // Weights are stored in float; on the strip 1e-7 of its length is 1e-4 of its width.
        EXPECT_NEAR(weights[i], roots.weightsOf(r)[i], f == 3 ? 1e-3 : 1e-5) << "face " << f << " root " << r;
      }
    }
  }
}

TEST(Roots, AgreeAlongSharedEdges) {
  // Two faces of different shape and plane share the edge a–b: a point of it has the same weights in both.
  const Vec3 a(0.3, -1.2, 0.7), b(2.1, 0.4, 1.9);
  const std::vector<Vec3> left{a, b, {1, 3, 2}, {-1, 2, 0.5}},
      right{b, a, {0, -4, 1}, {2, -3, 2}, {4, -2, 2.5}};
  const RootFace leftFace(left), rightFace(right);
  std::vector<double> l(4), r(5);
  for (double t = 0.05; t < 1; t += 0.05) {
    // Corners are projected into each face's plane, so the edge's image differs; its parameter does not.
    leftFace.weights((1 - t) * leftFace.polygon()[0] + t * leftFace.polygon()[1], l);
    rightFace.weights((1 - t) * rightFace.polygon()[1] + t * rightFace.polygon()[0], r);
    const Vec3 fromLeft = l[0] * left[0] + l[1] * left[1] + l[2] * left[2] + l[3] * left[3];
    Vec3 fromRight = Vec3::Zero();
    for (int i = 0; i < 5; ++i) fromRight += r[i] * right[i];
    EXPECT_LE((fromLeft - fromRight).norm(), 1e-12 * 5);  // of the diameter
  }
}

TEST(Roots, TriangulatesAFaceThatCrossesItself) {
  const std::vector<Vec3> bow{{0, 0, 0}, {3, 0, -2}, {3, 0, 0}, {0, 0, -1}};  // lobes of different size
  const RootFace face(bow);
  ASSERT_TRUE(face.triangulated());
  ASSERT_FALSE(face.barren());
  std::vector<double> weights(4);
  for (double u = 0.05; u < 1; u += 0.1) {
    for (double v = 0.05; v < 1; v += 0.1) {
      EXPECT_FALSE(face.weights(face.fromSquare(u, v), weights));
      EXPECT_NEAR(std::accumulate(weights.begin(), weights.end(), 0.0), 1, 1e-14);
      EXPECT_GE(*std::min_element(weights.begin(), weights.end()), 0);
    }
  }
  const HairMesh mesh = samples::column(bow, 2);
  const RootSet roots = placeRoots(mesh, {.count = 50}).value();
  EXPECT_EQ(roots.triangulatedFaces, 1u);
  EXPECT_EQ(roots.size(), 50u);
}

TEST(Roots, AFaceWithoutAreaBearsNone) {
  HairMesh mesh = samples::grid(2, 1, 1);
  for (const std::uint32_t v : mesh.bundles()[0].face(0)) mesh.setPosition(v, {1, 0, mesh.position(v).z()});
  const RootSet roots = placeRoots(mesh, {.count = 10}).value();
  EXPECT_EQ(roots.barrenBundles, 1u);
  EXPECT_EQ(roots.size(), 10u);
  for (const std::uint32_t b : roots.bundles) EXPECT_EQ(b, 1u);
}

}  // namespace
}  // namespace coif
