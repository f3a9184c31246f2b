// Mean value coordinates: four ways to compute them, against 113-bit arithmetic, ever closer to an edge.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "bench/bench.h"
#include "bench/bench_text.h"
#include "coif/base/random.h"
#include "coif/strands/mean_value.h"

__extension__ typedef __float128 Quad;

namespace coif {

template <>
struct MeanValueMath<Quad> {
  static Quad sqrt(Quad value) {  // two Newton steps double the long double's 64 bits
    if (!(value > 0)) return 0;
    Quad root = std::sqrt(static_cast<long double>(value));
    for (int step = 0; step < 2; ++step) root = (root + value / root) / 2;
    return root;
  }
  static bool isFinite(Quad value) { return value - value == 0; }
};

namespace {

constexpr std::size_t kMaxCorners = 8;

/// Points inside one polygon, all at one distance from an edge.
struct Problem {
  std::vector<double> xy;  // corners
  std::vector<Vec2> points;
  std::vector<std::array<double, kMaxCorners>> truth;
  std::size_t corners() const { return xy.size() / 2; }
};

/// An irregular convex polygon and points at distance `away` (of its diameter) from one of its edges.
Problem makeProblem(std::size_t corners, double away, std::size_t count, std::uint64_t seed) {
  const CounterRandom random(seed, corners);
  Problem problem;
  for (std::size_t i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * (double(i) + 0.4 * random.uniform(i)) / double(corners);
    problem.xy.insert(problem.xy.end(), {0.5 * std::cos(angle), 0.5 * std::sin(angle)});
  }
  const CounterRandom draw = random.child(std::uint64_t(-std::log10(away) * 100));
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = draw.below(2 * k, std::uint32_t(corners)), j = (i + 1) % corners;
    const Vec2 a(problem.xy[2 * i], problem.xy[2 * i + 1]), b(problem.xy[2 * j], problem.xy[2 * j + 1]);
    const Vec2 inwards = Vec2(a.y() - b.y(), b.x() - a.x()).normalized();
    // Half along towards the centre of the edge, so that 0.1 away is inside any of them.
    const double t = 0.25 + 0.5 * draw.uniform(2 * k + 1);
    // Rounded to float, so that every method is asked about the same point.
    problem.points.push_back((a + t * (b - a) + away * inwards).cast<float>().cast<double>());
  }
  for (double& x : problem.xy) x = double(float(x));
  problem.truth.resize(count);
  std::vector<Quad> xy(problem.xy.begin(), problem.xy.end()), out(corners);
  for (std::size_t k = 0; k < count; ++k) {
    meanValueWeights<Quad>(xy.data(), corners, problem.points[k].x(), problem.points[k].y(), out.data());
    for (std::size_t i = 0; i < corners; ++i) problem.truth[k][i] = double(out[i]);
  }
  return problem;
}

/// The textbook form: the angle by arccos, then its half's tangent.
template <class T>
void arccosWeights(const T* xy, std::size_t n, T x, T y, T* out) {
  std::array<T, kMaxCorners> tangent, radius;
  for (std::size_t i = 0; i < n; ++i) radius[i] = std::hypot(xy[2 * i] - x, xy[2 * i + 1] - y);
  T sum = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t j = (i + 1) % n;
    const T dot = (xy[2 * i] - x) * (xy[2 * j] - x) + (xy[2 * i + 1] - y) * (xy[2 * j + 1] - y);
    tangent[i] = std::tan(std::acos(std::clamp(dot / (radius[i] * radius[j]), T(-1), T(1))) / 2);
  }
  for (std::size_t i = 0; i < n; ++i) sum += out[i] = (tangent[(i + n - 1) % n] + tangent[i]) / radius[i];
  for (std::size_t i = 0; i < n; ++i) out[i] /= sum;
}

/// Barycentric coordinates in the fan triangle that holds the point: cheap, but another function inside the
/// face.
void fanWeights(const double* xy, std::size_t n, double x, double y, double* out) {
  std::fill(out, out + n, 0.0);
  const auto cross = [&](std::size_t i, std::size_t j) {
    return (xy[2 * i] - x) * (xy[2 * j + 1] - y) - (xy[2 * i + 1] - y) * (xy[2 * j] - x);
  };
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double a = cross(i, i + 1), b = cross(i + 1, 0), c = cross(0, i);
    if (i + 2 < n && (a < 0 || b < 0 || c < 0)) continue;
    out[0] = a / (a + b + c), out[i] = b / (a + b + c), out[i + 1] = c / (a + b + c);
    return;
  }
}

/// Runs one method over all points; error: greatest |λ − truth|.
template <class T, class Method>
BenchSample measure(const char* name, double away, const Problem& problem, const Method& method) {
  const std::size_t n = problem.corners();
  const std::vector<T> xy(problem.xy.begin(), problem.xy.end());
  std::vector<std::array<T, kMaxCorners>> out(problem.points.size());
  BenchSample sample{name, {{"distance", shortNumber(away)}}, 0, 0, 0};
  sample.seconds = fastestSeconds([&] {
    for (std::size_t k = 0; k < out.size(); ++k) {
      method(xy.data(), n, T(problem.points[k].x()), T(problem.points[k].y()), out[k].data());
    }
  });
  for (std::size_t k = 0; k < out.size(); ++k) {
    for (std::size_t i = 0; i < n; ++i) {
      const double error = std::abs(double(out[k][i]) - problem.truth[k][i]);
      sample.error = error <= sample.error ? sample.error : error;  // NaN is kept
    }
  }
  return sample;
}

}  // namespace

BenchReport benchCoordinates(const BenchOptions& options) {
  BenchReport report;
  report.title = "Mean value coordinates";
  report.about =
      "Points at distances of 0.1 to 1e-12 (of the diameter) from an edge of an irregular quad, hexagon and "
      "octagon. "
      "Points and corners are floats, so that every method is asked the same question; a point that rounds "
      "on to the "
      "edge or past it stays. The error is the greatest difference of one coordinate. Ratios in the data are "
      "to the "
      "double pair at 0.1. Fan triangles compute another function: their error is the price of the cheaper "
      "rule.";
  const std::size_t count = options.quick ? 500 : 20000;
  double worstFloat = 0, worstDouble = 0, worstArccos = 0;
  for (const std::size_t corners : {4, 6, 8}) {
    BenchPlot plot;
    plot.name = "coordinates-" + std::to_string(corners);
    plot.title = "Mean value coordinates in a polygon of " + std::to_string(corners) + " corners";
    plot.errorUnit = "greatest error of a coordinate";
    plot.truth = "the same formula in 113 bits, error below 1e-30";
    for (int digits = 1; digits <= 12; digits += options.quick ? 5 : 1) {
      const double away = std::pow(10.0, -digits);
      const Problem problem = makeProblem(corners, away, count, options.seed);
      plot.samples.push_back(measure<float>("float pair", away, problem, meanValueWeights<float>));
      worstFloat = std::max(worstFloat, plot.samples.back().error);
      plot.samples.push_back(measure<double>("double pair", away, problem, meanValueWeights<double>));
      worstDouble = std::max(worstDouble, plot.samples.back().error);
      plot.samples.push_back(measure<float>("arccos and tan, float", away, problem, arccosWeights<float>));
      worstArccos = std::max(worstArccos, plot.samples.back().error);
      plot.samples.push_back(measure<double>("arccos and tan, double", away, problem, arccosWeights<double>));
      plot.samples.push_back(measure<double>("fan triangles", away, problem, fanWeights));
    }
    plot.rateAgainst("double pair", {{"distance", shortNumber(0.1)}});
    report.plots.push_back(std::move(plot));
  }
  report.figures.push_back({"float pair, worst error", worstFloat, "", Bar::AtMost, 1e-6});
  report.figures.push_back({"double pair, worst error", worstDouble, "", Bar::AtMost, 1e-13});
  report.figures.push_back({"arccos form in float, worst error / the pair's", worstArccos / worstFloat, ""});
  return report;
}

}  // namespace coif
