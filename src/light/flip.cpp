#include <algorithm>
#include <cmath>

#include "coif/base/parallel.h"
#include "coif/base/vec.h"
#include "coif/light/image_metrics.h"
#include "light/same_size.h"

namespace coif {
namespace {

constexpr double kPi = 3.14159265358979323846;
// The paper's constants (section 4): exponents of colour and features, and where the colour error bends.
constexpr double kColorExponent = 0.7, kFeatureExponent = 0.5, kBendAt = 0.4, kBendTo = 0.95;
constexpr double kFeatureWidthDeg = 0.082;

// Three planes of a picture; x fastest.
struct Planes {
  int width = 0, height = 0;
  std::vector<Vec3> values;
  Planes(int w, int h) : width(w), height(h), values(std::size_t(w) * std::size_t(h)) {}
  // Beyond the border the nearest pixel stands.
  const Vec3& at(int x, int y) const {
    return values[std::size_t(std::clamp(y, 0, height - 1)) * std::size_t(width) +
                  std::size_t(std::clamp(x, 0, width - 1))];
  }
};

// sRGB's primaries to XYZ with a white of Y = 1 (exact, from the chromaticities and D65).
const Mat3& xyzFromRgb() {
  static const Mat3 matrix = (Mat3() << 10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794,
                              2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897,
                              1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382)
                                 .finished();
  return matrix;
}
Vec3 white() {
  return xyzFromRgb() * Vec3::Ones();
}

Vec3 opponentFromXyz(const Vec3& xyz) {  // YCxCz: linear, so it may be filtered
  const Vec3 n = xyz.cwiseQuotient(white());
  return {116 * n.y() - 16, 500 * (n.x() - n.y()), 200 * (n.y() - n.z())};
}
Vec3 xyzFromOpponent(const Vec3& v) {
  const double y = (v.x() + 16) / 116;
  return Vec3(y + v.y() / 500, y, y - v.z() / 200).cwiseProduct(white());
}

// CIELAB with Hunt's correction: the dark is seen with less colour.
Vec3 huntLab(const Vec3& rgb) {
  const Vec3 n = (xyzFromRgb() * rgb).cwiseQuotient(white());
  const auto f = [](double t) {
    constexpr double kDelta = 6.0 / 29;
    return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0 / 29;
  };
  const double lightness = 116 * f(n.y()) - 16;
  return {lightness, 0.01 * lightness * 500 * (f(n.x()) - f(n.y())),
          0.01 * lightness * 200 * (f(n.y()) - f(n.z()))};
}

double hyab(const Vec3& a, const Vec3& b) {
  return std::abs(a.x() - b.x()) + std::hypot(a.y() - b.y(), a.z() - b.z());
}

double colorError(const Vec3& a, const Vec3& b) {
  static const double kMost = std::pow(hyab(huntLab(Vec3::UnitY()), huntLab(Vec3::UnitZ())), kColorExponent);
  const double error = std::pow(hyab(a, b), kColorExponent), bend = kBendAt * kMost;
  if (error < bend) return kBendTo * error / bend;
  return kBendTo + (1 - kBendTo) * (error - bend) / (kMost - bend);
}

// A kernel over [−radius, radius], one weight a channel.
struct Kernel {
  int radius = 0;
  std::vector<Vec3> weights;
  const Vec3& at(int d) const { return weights[std::size_t(d + radius)]; }
};

template <class Value>
Kernel makeKernel(int radius, Value value) {
  Kernel kernel{radius, {}};
  for (int d = -radius; d <= radius; ++d) kernel.weights.push_back(value(d));
  return kernel;
}

// Every pixel as the sum of its row (or column) under the kernel.
Planes filtered(const Context& context, const Planes& in, const Kernel& kernel, bool alongX) {
  Planes out(in.width, in.height);
  parallelFor(context, std::size_t(in.height), 4, [&](std::size_t begin, std::size_t end) {
    for (int y = int(begin); y < int(end); ++y) {
      for (int x = 0; x < in.width; ++x) {
        Vec3 sum = Vec3::Zero();
        for (int d = -kernel.radius; d <= kernel.radius; ++d) {
          sum += kernel.at(d).cwiseProduct(alongX ? in.at(x + d, y) : in.at(x, y + d));
        }
        out.values[std::size_t(y) * std::size_t(in.width) + std::size_t(x)] = sum;
      }
    }
  });
  return out;
}

// The contrast sensitivity of the eye: a gaussian a channel, and a second, wider one for blue-yellow. In
// degrees g(x) = a √(π/b) exp(−π² x² / b); the channel's two-dimensional kernel is the sum of its gaussians
// over the sum of all weights.
struct Sensitivity {
  Kernel first, second;
};
Sensitivity sensitivity(double pixelsPerDegree) {
  const Vec3 a(1, 1, 34.1), b(0.0047, 0.0053, 0.04);
  constexpr double kSecondA = 13.5, kSecondB = 0.025;
  const int radius = int(std::ceil(3 * std::sqrt(0.04 / (2 * kPi * kPi)) * pixelsPerDegree));
  const auto gaussian = [&](int d, double amplitude, double width) {
    const double x = d / pixelsPerDegree;
    return std::sqrt(amplitude * std::sqrt(kPi / width)) * std::exp(-kPi * kPi * x * x / width);
  };
  Sensitivity s;
  s.first = makeKernel(radius, [&](int d) {
    return Vec3(gaussian(d, a[0], b[0]), gaussian(d, a[1], b[1]), gaussian(d, a[2], b[2]));
  });
  s.second = makeKernel(radius, [&](int d) { return Vec3(0, 0, gaussian(d, kSecondA, kSecondB)); });
  Vec3 first = Vec3::Zero(), second = Vec3::Zero();
  for (const Vec3& w : s.first.weights) first += w;
  for (const Vec3& w : s.second.weights) second += w;
  const Vec3 scale = (first.cwiseAbs2() + second.cwiseAbs2()).cwiseSqrt().cwiseInverse();
  for (Vec3& w : s.first.weights) w = w.cwiseProduct(scale);
  for (Vec3& w : s.second.weights) w = w.cwiseProduct(scale);
  return s;
}

// What the eye resolves, as Hunt-corrected Lab.
Planes perceived(const Context& context, const Planes& opponent, double pixelsPerDegree) {
  const Sensitivity s = sensitivity(pixelsPerDegree);
  Planes result = filtered(context, filtered(context, opponent, s.first, true), s.first, false);
  const Planes second = filtered(context, filtered(context, opponent, s.second, true), s.second, false);
  const Mat3 rgbFromXyz = xyzFromRgb().inverse();
  for (std::size_t i = 0; i < result.values.size(); ++i) {
    const Vec3 rgb = rgbFromXyz * xyzFromOpponent(result.values[i] + second.values[i]);
    result.values[i] = huntLab(rgb.cwiseMax(0).cwiseMin(1));
  }
  return result;
}

// Strengths of edges and of points: lengths of the first and second derivatives of the brightness under a
// gaussian. A kernel's positive and its negative weights are made to sum to one each.
struct Features {
  std::vector<double> edges, points;
};
Features features(const Context& context, const Planes& opponent, double pixelsPerDegree) {
  const double sigma = 0.5 * kFeatureWidthDeg * pixelsPerDegree;
  const int radius = int(std::ceil(3 * sigma));
  // Channels: smoothing, first derivative, second derivative.
  Kernel kernel = makeKernel(radius, [&](int d) {
    const double g = std::exp(-d * d / (2 * sigma * sigma));
    return Vec3(g, -d * g, (d * d / (sigma * sigma) - 1) * g);
  });
  double smooth = 0;
  Vec3 positive = Vec3::Zero(), negative = Vec3::Zero();
  for (const Vec3& w : kernel.weights) {
    smooth += w[0];
    positive += w.cwiseMax(0);
    negative -= w.cwiseMin(0);
  }
  for (Vec3& w : kernel.weights) {
    w[0] /= smooth;
    for (int c : {1, 2}) w[c] /= w[c] > 0 ? positive[c] : negative[c];
  }
  Kernel smoothing = kernel;
  for (Vec3& w : smoothing.weights) w = Vec3::Constant(w[0]);
  Planes brightness(opponent.width, opponent.height);
  for (std::size_t i = 0; i < brightness.values.size(); ++i) {
    brightness.values[i] = Vec3::Constant((opponent.values[i].x() + 16) / 116);
  }
  const Planes x = filtered(context, filtered(context, brightness, kernel, true), smoothing, false);
  const Planes y = filtered(context, filtered(context, brightness, smoothing, true), kernel, false);
  Features result;
  for (std::size_t i = 0; i < x.values.size(); ++i) {
    result.edges.push_back(std::hypot(x.values[i][1], y.values[i][1]));
    result.points.push_back(std::hypot(x.values[i][2], y.values[i][2]));
  }
  return result;
}

Planes opponentOf(const FloatImage& image) {
  Planes planes(image.width, image.height);
  for (std::size_t i = 0; i < planes.values.size(); ++i) {
    const Vec3 rgb = Eigen::Map<const Vec3f>(image.rgba.data() + 4 * i).cast<double>();
    planes.values[i] = opponentFromXyz(xyzFromRgb() * rgb.cwiseMax(0).cwiseMin(1));
  }
  return planes;
}

}  // namespace

Result<Flip> flip(const FloatImage& image, const FloatImage& reference, double pixelsPerDegree,
                  const Context& context) {
  COIF_TRY(checkComparable(image, reference));
  if (!(pixelsPerDegree >= 4 && pixelsPerDegree <= 1000)) {
    return makeError(ErrorCode::InvalidArgument, "pixels per degree must lie between 4 and 1000");
  }
  const Planes a = opponentOf(image), b = opponentOf(reference);
  const Planes seenA = perceived(context, a, pixelsPerDegree), seenB = perceived(context, b, pixelsPerDegree);
  const Features featuresA = features(context, a, pixelsPerDegree),
                 featuresB = features(context, b, pixelsPerDegree);
  if (context.cancelled()) return makeError(ErrorCode::Cancelled, "cancelled");
  Flip result;
  result.map.resize(a.values.size());
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    const double color = colorError(seenA.values[i], seenB.values[i]);
    const double feature = std::max(std::abs(featuresA.edges[i] - featuresB.edges[i]),
                                    std::abs(featuresA.points[i] - featuresB.points[i]));
    const double error = std::pow(color, 1 - std::pow(feature / std::sqrt(2.0), kFeatureExponent));
    result.map[i] = float(error);
    result.mean += error;
  }
  result.mean /= double(a.values.size());
  return result;
}

}  // namespace coif
