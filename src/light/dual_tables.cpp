#include "dual_tables.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace coif {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kInclinations = 65, kAzimuthInclinations = 33, kAzimuths = 91;
constexpr double kLossAtLeast = 1e-9;  // of 1 − f − b and of 1 − f²: their inverses stay finite
constexpr double kShiftAtMost = 0.5, kVarianceAtMost = 10;
// Of θ_i + θ_o when directions are even over the sphere: no lobe is wider. π²/4 − 2.
constexpr double kVarianceOfSphere = kPi * kPi / 4 - 2;

Vec3 texel(const std::vector<float>& table, std::size_t index) {
  return Vec3(table[3 * index], table[3 * index + 1], table[3 * index + 2]);
}

// Trapezoid weight of a node, both halves of the circle.
double circleWeight(int node) {
  return 2 * kPi / (kAzimuths - 1) * (node == 0 || node == kAzimuths - 1 ? 0.5 : 1);
}

std::size_t azimuthIndex(int lobe, int inclination, int azimuth) {
  return (std::size_t(lobe) * kAzimuthInclinations + std::size_t(inclination)) * kAzimuths +
         std::size_t(azimuth);
}

void put(std::vector<float>& table, std::size_t index, const Vec3& value) {
  for (int c = 0; c < 3; ++c) table[3 * index + std::size_t(c)] = float(value[c]);
}

// N at the nodes, scaled so that the trapezoid rule gives each lobe's attenuation exactly.
void fillAzimuthal(const FibreScattering& fibre, DualScatteringTables& out) {
  std::array<double, kAzimuths> phis;
  for (int a = 0; a < kAzimuths; ++a) phis[std::size_t(a)] = kPi * a / (kAzimuths - 1);
  for (int i = 0; i < kAzimuthInclinations; ++i) {
    const double theta = kPi / 2 * i / (kAzimuthInclinations - 1);
    const std::array<Vec3, 4> exact = fibre.attenuation(-theta, theta);
    std::array<Vec3, 4> sum;
    sum.fill(Vec3::Zero());
    const std::vector<std::array<Vec3, 4>> ring = fibre.azimuthal(-theta, theta, phis);
    for (int a = 0; a < kAzimuths; ++a) {
      for (int p = 0; p < 4; ++p) sum[p] += ring[std::size_t(a)][p] * circleWeight(a);
    }
    for (int p = 0; p < 4; ++p) {
      for (int a = 0; a < kAzimuths; ++a) {
        Vec3 value = ring[std::size_t(a)][p];
        for (int c = 0; c < 3; ++c) value[c] = sum[p][c] > 1e-30 ? value[c] * exact[p][c] / sum[p][c] : 0;
        put(out.azimuthal, azimuthIndex(p, i, a), value);
      }
    }
  }
}

// (25): light even over the front half of its cone. A running mean over half the circle.
void fillScattered(DualScatteringTables& out) {
  constexpr int half = (kAzimuths - 1) / 2;
  for (int p = 0; p < 4; ++p) {
    for (int i = 0; i < kAzimuthInclinations; ++i) {
      for (int a = 0; a < kAzimuths; ++a) {
        Vec3 sum = Vec3::Zero();
        for (int shift = -half; shift <= half; ++shift) {
          int node = std::abs(a - shift);
          if (node > kAzimuths - 1) node = 2 * (kAzimuths - 1) - node;
          sum += texel(out.azimuthal, azimuthIndex(p, i, node)) * (std::abs(shift) == half ? 0.5 : 1);
        }
        put(out.azimuthalScattered, azimuthIndex(p, i, a), sum / (2 * half));
      }
    }
  }
}

// ∫ longitudinal cos θ_i dθ_i, within six deviations of the lobe's middle.
double longitudinalArea(const FibreScattering& fibre, FibreLobe lobe, double theta) {
  if (fibre.parameters().model == FibreModel::Chiang) return 1;
  const double middle = -theta + fibre.lobeShift(lobe), reach = 6 * std::sqrt(fibre.lobeVariance(lobe));
  const double low = std::max(-kPi / 2, middle - reach), high = std::min(kPi / 2, middle + reach);
  constexpr int steps = 200;
  double sum = 0;
  for (int s = 0; s < steps && high > low; ++s) {
    const double at = low + (high - low) * (s + 0.5) / steps;
    sum += fibre.longitudinal(lobe, at, theta) * std::cos(at) * (high - low) / steps;
  }
  return sum;
}

// Attenuation, shift and variance of lobes that are added up.
struct Gathered {
  double weight = 0, shift = 0, square = 0;
  void add(double w, double s, double variance) {
    weight += w, shift += w * s, square += w * (variance + s * s);
  }
  double meanShift() const { return weight > 0 ? shift / weight : 0; }
  double variance() const {
    return weight > 0 ? std::max(0.0, square / weight - meanShift() * meanShift()) : 0;
  }
};

}  // namespace

Vec3 overInclination(const std::vector<float>& table, int nodes, double theta) {
  const double x = std::clamp(theta / kPi + 0.5, 0.0, 1.0) * (nodes - 1);
  const int low = std::min(int(x), nodes - 2);
  const double t = x - low;
  return (1 - t) * texel(table, std::size_t(low)) + t * texel(table, std::size_t(low) + 1);
}

Vec3 overAzimuth(const DualScatteringTables& tables, const std::vector<float>& table, int lobe,
                 double inclination, double phi) {
  const double x = std::clamp(inclination / (kPi / 2), 0.0, 1.0) * (tables.azimuthInclinations - 1);
  const double folded = std::abs(phi - 2 * kPi * std::round(phi / (2 * kPi)));
  const double y = std::clamp(folded / kPi, 0.0, 1.0) * (tables.azimuths - 1);
  const int i = std::min(int(x), tables.azimuthInclinations - 2), a = std::min(int(y), tables.azimuths - 2);
  const double s = x - i, t = y - a;
  const auto row = [&](int r) -> Vec3 {
    const std::size_t at = azimuthIndex(lobe, r, a);
    return (1 - t) * texel(table, at) + t * texel(table, at + 1);
  };
  return (1 - s) * row(i) + s * row(i + 1);
}

FibreMeans fibreMeans(const FibreScattering& fibre, const DualScatteringTables& tables, double theta,
                      int channel) {
  Gathered forward, backward;
  for (int p = 0; p < 4; ++p) {
    const double area = longitudinalArea(fibre, kFibreLobes[p], theta);
    const double at = fibre.azimuthalInclination(-theta, theta);
    double front = 0, all = 0;
    for (int a = 0; a < kAzimuths; ++a) {
      const double phi = kPi * a / (kAzimuths - 1);
      const double value = overAzimuth(tables, tables.azimuthal, p, at, phi)[channel] * circleWeight(a);
      // Of arrivals from the front half, the share for which this difference of azimuths leads on forwards.
      front += value * phi / kPi;
      all += value;
    }
    const double variance = std::min(fibre.lobeVariance(kFibreLobes[p]), kVarianceOfSphere);
    forward.add(area * front, fibre.lobeShift(kFibreLobes[p]), variance);
    backward.add(area * (all - front), fibre.lobeShift(kFibreLobes[p]), variance);
  }
  // Models that are not area-preserving at grazing angles must not gain there.
  const double held = 1 / std::max(1.0, forward.weight + backward.weight);
  return {forward.weight * held, backward.weight * held, forward.meanShift(),
          backward.meanShift(),  forward.variance(),     backward.variance()};
}

DualScatteringTables buildDualTables(const FibreScattering& fibre, DualFormulas formulas) {
  DualScatteringTables out;
  out.inclinations = kInclinations;
  out.azimuthInclinations = kAzimuthInclinations;
  out.azimuths = kAzimuths;
  out.azimuthal.resize(std::size_t(12) * kAzimuthInclinations * kAzimuths);
  out.azimuthalScattered.resize(out.azimuthal.size());
  fillAzimuthal(fibre, out);
  fillScattered(out);
  for (auto* table : {&out.forwardAttenuation, &out.forwardVariance, &out.backwardAttenuation,
                      &out.backscatterAttenuation, &out.backscatterShift, &out.backscatterVariance}) {
    table->resize(std::size_t(3) * kInclinations);
  }
  for (int i = 0; i < kInclinations; ++i) {
    const double theta = kPi * (double(i) / (kInclinations - 1) - 0.5);
    for (int c = 0; c < 3; ++c) {
      const std::size_t at = std::size_t(3 * i + c);
      const FibreMeans means = fibreMeans(fibre, out, theta, c);
      const Backscatter back = backscatterOf(means, formulas);
      out.forwardAttenuation[at] = float(means.attenuationForward);
      out.forwardVariance[at] = float(means.varianceForward);
      out.backwardAttenuation[at] = float(means.attenuationBackward);
      out.backscatterAttenuation[at] = float(back.attenuation);
      out.backscatterShift[at] = float(back.shift);
      out.backscatterVariance[at] = float(back.variance);
    }
  }
  return out;
}

namespace {

Backscatter printedBackscatter(const FibreMeans& m) {
  const double f = m.attenuationForward, b = m.attenuationBackward;
  const double x = f * f, o = std::max(kLossAtLeast, 1 - x), b2 = b * b, b3 = b2 * b;
  Backscatter out;
  out.attenuation = b * x / o + b3 * x / (o * o * o);  // (11), (13)
  out.shift = m.shiftBackward * (1 - 2 * b2 / (o * o)) +
              m.shiftForward * (2 * o * o + 4 * x * b2) / (o * o * o);  // (16)
  const double vf = m.varianceForward, vb = m.varianceBackward;
  const double over = b + b3 * (2 * std::sqrt(vf) + 3 * std::sqrt(vb));
  const double deviation =
      over > 0 ? (1 + 0.7 * x) * (b * std::sqrt(2 * vf + vb) + b3 * std::sqrt(2 * vf + 3 * vb)) / over
               : std::sqrt(vb);  // (17)
  out.variance = deviation * deviation;
  return out;
}

// √Q and the reflectance R of endlessly many layers.
struct EndlessPile {
  double root, reflected;
  EndlessPile(double f, double b)
      : root(std::sqrt(std::max(kLossAtLeast, 1 - f - b) * (1 - b + f) * (1 + b - f) * (1 + b + f))),
        reflected(2 * b / (1 + b * b - f * f + root)) {}
};

Backscatter correctedBackscatter(const FibreMeans& m) {
  const double f = m.attenuationForward, b = m.attenuationBackward;
  const auto [root, reflected] = EndlessPile(f, b);
  Backscatter out;
  // b R² − (1 + b² − f²) R + b = 0, so R − b = f² R / (1 − b R): no difference of nearly equal numbers.
  out.attenuation = f * f * reflected / (1 - b * reflected);
  if (!(out.attenuation > 0)) {
    out.shift = m.shiftBackward;
    out.variance = m.varianceBackward;
    return out;
  }
  // Mean numbers of scatterings: f ∂/∂f and b ∂/∂b of log Ā_b.
  const double forwards = 2 * f * f * reflected / root / out.attenuation;
  const double backwards = b * ((reflected * reflected - 2 * b * reflected + 1) / root - 1) / out.attenuation;
  out.shift = forwards * m.shiftForward + backwards * m.shiftBackward;
  out.variance = forwards * m.varianceForward + backwards * m.varianceBackward;
  return out;
}

}  // namespace

Backscatter backscatterOf(const FibreMeans& fibre, DualFormulas formulas) {
  FibreMeans held = fibre;
  const double sum = held.attenuationForward + held.attenuationBackward;
  if (sum > 1) held.attenuationForward /= sum, held.attenuationBackward /= sum;
  Backscatter out = formulas == DualFormulas::Printed ? printedBackscatter(held) : correctedBackscatter(held);
  out.attenuation = std::clamp(out.attenuation, 0.0, 1.0);
  out.shift = std::clamp(out.shift, -kShiftAtMost, kShiftAtMost);
  out.variance = std::clamp(out.variance, 1e-8, kVarianceAtMost);
  return out;
}

double backscatterOfPile(double attenuationForward, double attenuationBackward, double behind) {
  const double held = std::max(1.0, attenuationForward + attenuationBackward);
  const double f = std::max(0.0, attenuationForward) / held, b = std::max(0.0, attenuationBackward) / held;
  const double reflected = EndlessPile(f, b).reflected;
  const double passed = f / (1 - b * reflected);  // from layer to layer, endlessly many of them behind
  const double decay = std::pow(passed, 2 * (std::max(0.0, behind) + 1));
  const double pile = reflected * (1 - decay) / (1 - reflected * reflected * decay);
  return std::max(0.0, pile - b);
}

}  // namespace coif
