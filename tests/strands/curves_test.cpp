// Splines, frames and distances of single curves.
#include <gtest/gtest.h>

#include <numbers>

#include "coif/base/random.h"
#include "coif/strands/catmull_rom.h"
#include "coif/strands/frames.h"
#include "coif/strands/hausdorff.h"

namespace coif {
namespace {

std::vector<Vec3> wiggle(std::size_t n, std::uint64_t key = 3) {
  const CounterRandom random(key);
  std::vector<Vec3> out;
  for (std::size_t i = 0; i < n; ++i) {
    out.emplace_back(double(i), 2 * random.uniform(3 * i), 1.5 * random.uniform(3 * i + 1));
  }
  return out;
}

/// Barry and Goldman's pyramid, straight from their paper, with the pinned end points given.
Vec3 pyramid(const std::array<Vec3, 4>& p, const std::array<double, 4>& t, double at) {
  const auto mix = [&](const Vec3& a, const Vec3& b, double ta, double tb) {
    return Vec3(((tb - at) * a + (at - ta) * b) / (tb - ta));
  };
  const Vec3 a1 = mix(p[0], p[1], t[0], t[1]), a2 = mix(p[1], p[2], t[1], t[2]),
             a3 = mix(p[2], p[3], t[2], t[3]);
  return mix(mix(a1, a2, t[0], t[2]), mix(a2, a3, t[1], t[3]), t[1], t[2]);
}

// Two formulas for one cubic: rounding of coordinates below 10.
TEST(CatmullRom, MatchesThePrintedMatrixAndThePyramid) {
  for (const Knots knots : {Knots::Uniform, Knots::Centripetal, Knots::Chordal}) {
    const double power = knots == Knots::Uniform ? 0 : knots == Knots::Centripetal ? 0.5 : 1;
    const std::vector<Vec3> points = wiggle(6);
    std::vector<Vec3> extended{2 * points[0] - points[1]};
    extended.insert(extended.end(), points.begin(), points.end());
    extended.push_back(2 * points[5] - points[4]);
    const std::vector<Vec3> found = catmullRom(points, 51, knots);
    for (std::size_t s = 0; s < 51; ++s) {
      const std::size_t k = std::min<std::size_t>(s / 10, 4);
      const double u = double(s) / 10 - double(k);
      const std::array<Vec3, 4> p{extended[k], extended[k + 1], extended[k + 2], extended[k + 3]};
      std::array<double, 4> t{};
      for (int i = 0; i < 3; ++i) t[i + 1] = t[i] + std::pow((p[i + 1] - p[i]).norm(), power);
      EXPECT_LE((pyramid(p, t, t[1] + u * (t[2] - t[1])) - found[s]).norm(), 1e-13);
      if (knots != Knots::Uniform) continue;
      const Vec3 printed =
          0.5 * (2 * p[1] + (p[2] - p[0]) * u + (2 * p[0] - 5 * p[1] + 4 * p[2] - p[3]) * u * u +
                 (3 * p[1] - p[0] - 3 * p[2] + p[3]) * u * u * u);
      EXPECT_LE((printed - found[s]).norm(), 1e-14 * 10);
    }
  }
}

TEST(CatmullRom, InterpolatesExactlyAndIsStraightThroughTwoPoints) {
  const std::vector<Vec3> points = wiggle(5);
  const std::vector<Vec3> found = catmullRom(points, 4 * 8 + 1);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(found[8 * i], points[i]);
  const std::vector<Vec3> two{{1, 2, 3}, {4, -2, 9}};
  const std::vector<Vec3> line = catmullRom(two, 11);
  for (std::size_t s = 0; s <= 10; ++s) {
    EXPECT_LE((line[s] - (two[0] + double(s) / 10 * (two[1] - two[0]))).norm(), 1e-14);
  }
  EXPECT_EQ(catmullRom(std::vector<Vec3>{{1, 2, 3}}, 4), std::vector<Vec3>(4, Vec3(1, 2, 3)));
}

// A difference quotient across a joint, h = 1e-6: first-order in h, second derivatives below 20.
TEST(CatmullRom, IsC1InItsKnots) {
  const std::vector<Vec3> points = wiggle(6, 8);
  for (const Knots knots : {Knots::Uniform, Knots::Centripetal, Knots::Chordal}) {
    const std::vector<double> d = knotIntervals(points, knots);
    const auto at = [&](double t) {
      std::vector<double> w(6);
      splineWeights(d, t, w);
      Vec3 sum = Vec3::Zero();
      for (int i = 0; i < 6; ++i) sum += w[i] * points[i];
      return sum;
    };
    for (int k = 1; k < 5; ++k) {
      const Vec3 left = (at(k) - at(k - 1e-6)) / (1e-6 * d[k - 1]),
                 right = (at(k + 1e-6) - at(k)) / (1e-6 * d[k]);
      EXPECT_LE((left - right).norm(), 1e-4 * left.norm()) << k;
    }
  }
}

TEST(CatmullRom, StaysFiniteThroughRepeatedPoints) {
  const std::vector<Vec3> points{{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}, {2, 1, 0}};
  for (const Knots knots : {Knots::Uniform, Knots::Centripetal, Knots::Chordal}) {
    for (const Vec3& p : catmullRom(points, 101, knots)) {
      EXPECT_TRUE(p.allFinite());
      EXPECT_LE(p.norm(), 4);  // no overshoot beyond a curve of length 2.4
    }
    for (const Vec3& p : catmullRom(std::vector<Vec3>(4, Vec3(1, 1, 1)), 9, knots))
      EXPECT_EQ(p, Vec3(1, 1, 1));
  }
}

double extent(const std::vector<Vec3>& points) {
  Vec3 lo = points[0], hi = points[0];
  for (const Vec3& p : points) lo = lo.cwiseMin(p), hi = hi.cwiseMax(p);
  return (hi - lo).norm();
}

// Truth: 4096 points in double. The chord error falls with the square of the spacing: 4 per doubling.
TEST(CatmullRom, ChordErrorIsOfSecondOrder) {
  const std::vector<Vec3> points = wiggle(6);
  const std::vector<Vec3> truth = catmullRom(points, 4096);
  double previous = 0;
  for (const std::size_t pieces : {10, 20, 40, 80, 160}) {  // per segment 2 … 32
    const double error = hausdorff(truth, catmullRom(points, pieces + 1)) / extent(truth);
    if (pieces >= 80) {  // coarser ones are not yet asymptotic
      EXPECT_NEAR(std::log2(previous / error), 2, 0.25) << pieces;
    }
    previous = error;
  }
  EXPECT_LT(previous, 1e-3);
}

TEST(CatmullRom, PiecesKeepTheChordErrorBelowTheTolerance) {
  for (const Knots knots : {Knots::Uniform, Knots::Centripetal, Knots::Chordal}) {
    for (std::uint64_t key = 0; key < 10; ++key) {
      const std::vector<Vec3> points = wiggle(7, key);
      const std::vector<double> d = knotIntervals(points, knots);
      const std::vector<Vec3> truth = catmullRom(points, 4096, knots);
      for (const double tolerance : {1e-1, 1e-2, 1e-3}) {
        std::vector<std::uint32_t> pieces;
        for (std::size_t k = 0; k < 6; ++k) {
          const auto [a, b] = secondDerivatives(points, d, k);
          pieces.push_back(chordPieces(std::max(a.norm(), b.norm()), tolerance));
        }
        const SplineTable table(d, pieceParameters(pieces));
        std::vector<Vec3> polyline(table.rows(), Vec3::Zero());
        for (std::size_t p = 0; p < table.rows(); ++p) {
          for (std::size_t i = 0; i < 7; ++i) polyline[p] += table.row(p)[i] * points[i];
        }
        EXPECT_LE(oneSidedHausdorff(truth, polyline), tolerance);
        // Not wasteful either: the bound is an equality for parabolas, so within a few times here.
        EXPECT_GE(oneSidedHausdorff(truth, polyline), tolerance / 20);
      }
    }
  }
}

void expectOrthonormal(const Frame& f) {
  EXPECT_NEAR(f.tangent.norm(), 1, 1e-14);
  EXPECT_NEAR(f.normal.norm(), 1, 1e-14);
  EXPECT_NEAR(f.tangent.dot(f.normal), 0, 1e-14);
  EXPECT_LE((f.tangent.cross(f.normal) - f.binormal).norm(), 1e-14);
}

std::vector<Frame> framesOf(const std::vector<Vec3>& points, const Frame& root = {}) {
  std::vector<Frame> out(points.size());
  parallelTransport(points, root, out);
  return out;
}

TEST(Frames, PlaneCurvesKeepTheirBinormalThroughInflections) {
  std::vector<Vec3> points;
  for (int i = 0; i <= 200; ++i) points.emplace_back(std::sin(0.1 * i), 0, 0.1 * i);  // six inflections
  Frame root;
  root.tangent = Vec3::UnitZ(), root.normal = Vec3::UnitX(), root.binormal = Vec3::UnitY();
  for (const Frame& frame : framesOf(points, root)) {
    expectOrthonormal(frame);
    EXPECT_LE((frame.binormal - Vec3::UnitY()).norm(), 1e-12);
  }
}

// On a helix of curvature κ and torsion τ the rotation-minimising frame turns against the Frenet frame by
// −τ·s: exact answer known, error of the method O(h⁴).
TEST(Frames, HelixTwistConvergesWithFourthOrder) {
  const double a = 1, b = 0.5, c = std::sqrt(a * a + b * b), turns = 3 * 2 * std::numbers::pi;
  double previous = 0;
  for (const int n : {100, 200, 400, 800}) {
    std::vector<Vec3> points;
    for (int i = -1; i <= n + 1; ++i) {
      const double t = turns * i / n;
      points.emplace_back(a * std::cos(t), a * std::sin(t), b * t);
    }
    const std::vector<Frame> frames = framesOf(points);
    const auto angle = [&](std::size_t i, double t) {  // of the frame's normal in the Frenet frame
      const Vec3 normal(-std::cos(t), -std::sin(t), 0);
      return std::atan2(frames[i].normal.dot(frames[i].tangent.cross(normal)), frames[i].normal.dot(normal));
    };
    const double twist = angle(std::size_t(n) + 1, turns) - angle(1, 0);
    const double error = std::abs(std::remainder(twist + b / (c * c) * turns * c, 2 * std::numbers::pi));
    if (n > 100) {
      EXPECT_GT(std::log2(previous / error), 3.5) << n << " error " << error;
    }
    previous = error;
  }
  EXPECT_LT(previous, 1e-3);
}

TEST(Frames, ZeroTangentsKeepThePreviousFrame) {
  const std::vector<Vec3> points{{0, 0, 0}, {0, 0, 0}, {0, 1, 0}, {0, 1, 0}, {0, 1, 0}, {1, 1, 0}};
  const std::vector<Frame> frames = framesOf(points);
  for (const Frame& frame : frames) expectOrthonormal(frame);
  EXPECT_EQ(frames[3].tangent, frames[2].tangent);
  for (const Frame& frame : framesOf(std::vector<Vec3>(3, Vec3(1, 2, 3))))
    EXPECT_EQ(frame.normal, Frame{}.normal);
}

TEST(Frames, StartFromTheRootFace) {
  const std::vector<Vec3> square{{0, 0, 0}, {0, 0, 2}, {2, 0, 2}, {2, 0, 0}};
  const Frame face = faceFrame(square);
  EXPECT_LE((face.tangent - Vec3::UnitY()).norm(), 1e-15);
  EXPECT_LE((face.normal - Vec3::UnitZ()).norm(), 1e-15);
  expectOrthonormal(turnedTo(face, Vec3(1, 2, -3)));
  expectOrthonormal(turnedTo(face, -face.tangent));
  // The least rotation moves the axis across both tangents not at all.
  const Vec3 axis = face.tangent.cross(Vec3(1, 2, -3)).normalized();
  const Frame turned = turnedTo(face, Vec3(1, 2, -3));
  EXPECT_NEAR(turned.normal.dot(axis), face.normal.dot(axis), 1e-14);
  EXPECT_EQ(faceFrame(std::vector<Vec3>(3, Vec3::Zero())).tangent, Frame{}.tangent);
}

TEST(Hausdorff, MeasuresKnownDistances) {
  const std::vector<Vec3> line{{0, 0, 0}, {1, 0, 0}}, bent{{0, 0, 0}, {0.5, 0.25, 0}, {1, 0, 0}},
      dot{{0, 3, 4}};
  EXPECT_DOUBLE_EQ(hausdorff(line, bent), 0.25);
  EXPECT_DOUBLE_EQ(oneSidedHausdorff(line, bent), 0);
  EXPECT_DOUBLE_EQ(oneSidedHausdorff(dot, line), 5);
  EXPECT_DOUBLE_EQ(oneSidedHausdorff(line, dot), std::sqrt(26));
}

}  // namespace
}  // namespace coif
