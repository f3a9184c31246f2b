// What a USD curve is between its control vertices, as points that a Catmull-Rom strand passes through.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace coif::io::usd {

enum class Basis { Linear, Bezier, Bspline, CatmullRom, Unknown };
enum class Wrap { Open, Periodic, Pinned };

struct CurveKind {
  Basis basis = Basis::Bezier;
  Wrap wrap = Wrap::Open;
  /// Points are the control vertices themselves (linear, pinned Catmull-Rom).
  bool plain() const {
    return wrap != Wrap::Periodic &&
           (basis == Basis::Linear || (basis == Basis::CatmullRom && wrap == Wrap::Pinned));
  }
};
CurveKind curveKind(std::string_view type, std::string_view basis, std::string_view wrap);

/// One point of a strand: Σ weight · vertex, and where between the varying values it lies.
struct Tap {
  std::array<std::uint32_t, 4> vertex{};  ///< within the curve
  std::array<float, 4> weight{};
  std::uint32_t knot = 0;  ///< varying value before it
  float t = 0;             ///< fraction towards the next
};

/// The points of a curve of `vertices` control vertices; empty when the kind has no such curve. Catmull-Rom
/// curves give the vertices they pass through; B-splines their knots and mid-segments, Béziers three points a
/// segment: both lie on the curve. Periodic curves end where they began. Surplus vertices of a Bézier (not 3k
/// + 1) are dropped.
std::vector<Tap> curveTaps(CurveKind kind, std::uint32_t vertices);

/// Varying values of a curve of `vertices` control vertices (one a knot); 0 when the kind has no such curve.
std::uint64_t varyingCount(CurveKind kind, std::uint32_t vertices);

}  // namespace coif::io::usd
