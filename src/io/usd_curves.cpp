#include "usd_curves.h"

namespace coif::io::usd {
namespace {

constexpr std::uint32_t kBsplineSamples = 2;  ///< a segment
constexpr std::uint32_t kBezierSamples = 3;   ///< a segment: as many points as control vertices

std::array<float, 4> bsplineWeights(double t) {
  const double s = 1 - t;
  return {float(s * s * s / 6), float((3 * t * t * t - 6 * t * t + 4) / 6),
          float((-3 * t * t * t + 3 * t * t + 3 * t + 1) / 6), float(t * t * t / 6)};
}

std::array<float, 4> bezierWeights(double t) {
  const double s = 1 - t;
  return {float(s * s * s), float(3 * s * s * t), float(3 * s * t * t), float(t * t * t)};
}

/// Segments between knots; 0 when there is no such curve.
std::uint32_t segmentCount(CurveKind kind, std::uint32_t n) {
  const bool periodic = kind.wrap == Wrap::Periodic;
  switch (kind.basis) {
    case Basis::Linear:
      return periodic ? (n >= 3 ? n : 0) : (n >= 2 ? n - 1 : 0);
    case Basis::Bezier:
      if (periodic) return n >= 3 && n % 3 == 0 ? n / 3 : 0;
      return n >= 4 ? (n - 1) / 3 : 0;
    case Basis::Bspline:
    case Basis::CatmullRom:
      if (periodic) return n >= 3 ? n : 0;
      if (kind.wrap == Wrap::Pinned) return n >= 2 ? n - 1 : 0;
      return n >= 4 ? n - 3 : 0;
    default:
      return 0;
  }
}

Tap onVertex(std::uint32_t vertex, std::uint32_t knot) {
  Tap tap;
  tap.vertex[0] = vertex;
  tap.weight[0] = 1;
  tap.knot = knot;
  return tap;
}

/// A point of a segment whose four vertices begin at `first` (may be -1); phantoms of pinned curves are
/// P[-1] = 2 P0 - P1 and P[n] = 2 P[n-1] - P[n-2], both within the four.
Tap between(CurveKind kind, std::uint32_t n, std::int64_t first, const std::array<float, 4>& weights) {
  Tap tap;
  tap.weight = weights;
  for (int i = 0; i < 4; ++i) {
    const std::int64_t v = first + i;
    if (kind.wrap == Wrap::Periodic) {
      tap.vertex[std::size_t(i)] = std::uint32_t((v + n) % n);
    } else if (v >= 0 && v < n) {
      tap.vertex[std::size_t(i)] = std::uint32_t(v);
    }
  }
  if (kind.wrap == Wrap::Periodic) return tap;
  if (first < 0) {
    tap.weight[1] += 2 * tap.weight[0];
    tap.weight[2] -= tap.weight[0];
    tap.weight[0] = 0;
  }
  if (first + 3 >= std::int64_t(n)) {
    tap.weight[2] += 2 * tap.weight[3];
    tap.weight[1] -= tap.weight[3];
    tap.weight[3] = 0;
  }
  return tap;
}

Tap sampled(CurveKind kind, std::uint32_t n, std::uint32_t segment, double t) {
  Tap tap;
  if (kind.basis == Basis::Bezier) {
    tap = between({Basis::Bezier, kind.wrap == Wrap::Periodic ? Wrap::Periodic : Wrap::Open}, n,
                  3 * std::int64_t(segment), bezierWeights(t));
  } else {
    const std::int64_t first = kind.wrap == Wrap::Open ? segment : std::int64_t(segment) - 1;
    tap = between(kind, n, first, bsplineWeights(t));
  }
  tap.knot = segment;
  tap.t = float(t);
  return tap;
}

}  // namespace

CurveKind curveKind(std::string_view type, std::string_view basis, std::string_view wrap) {
  CurveKind kind;
  if (type == "linear") {
    kind.basis = Basis::Linear;
  } else if (basis == "bspline") {
    kind.basis = Basis::Bspline;
  } else if (basis == "catmullRom") {
    kind.basis = Basis::CatmullRom;
  } else if (!basis.empty() && basis != "bezier") {
    kind.basis = Basis::Unknown;
  }
  kind.wrap = wrap == "periodic" ? Wrap::Periodic : wrap == "pinned" ? Wrap::Pinned : Wrap::Open;
  return kind;
}

std::uint64_t varyingCount(CurveKind kind, std::uint32_t vertices) {
  const std::uint32_t segments = segmentCount(kind, vertices);
  return segments == 0 ? 0 : std::uint64_t(segments) + (kind.wrap == Wrap::Periodic ? 0 : 1);
}

std::vector<Tap> curveTaps(CurveKind kind, std::uint32_t n) {
  std::vector<Tap> taps;
  const std::uint32_t segments = segmentCount(kind, n);
  if (segments == 0) return taps;
  if (kind.basis == Basis::Linear || kind.basis == Basis::CatmullRom) {
    const bool inner =
        kind.basis == Basis::CatmullRom && kind.wrap == Wrap::Open;  // ends only shape the others
    for (std::uint32_t k = 0; k <= segments; ++k) {
      const std::uint32_t knot = kind.wrap == Wrap::Periodic ? k % n : k;
      taps.push_back(onVertex(inner ? k + 1 : knot, knot));
    }
    return taps;
  }
  const std::uint32_t samples = kind.basis == Basis::Bspline ? kBsplineSamples : kBezierSamples;
  for (std::uint32_t s = 0; s < segments; ++s) {
    for (std::uint32_t i = 0; i < samples; ++i) taps.push_back(sampled(kind, n, s, double(i) / samples));
  }
  taps.push_back(sampled(kind, n, segments - 1, 1));
  return taps;
}

}  // namespace coif::io::usd
