// Hair to style: straight, upright, a centimetre a unit.
#pragma once

#include "coif/strands/grow.h"
#include "coif/style/style_kinds.h"
#include "coif/style/style_plan.h"
#include "strands/sample_meshes.h"

namespace coif::samples {

/// n × n unit quads in the xz plane, hair of `height` straight up y, in `layers` layers.
inline HairMesh lawn(std::uint32_t n, double height, std::uint32_t layers = 4) {
  HairMesh mesh = gridRoot(n, n);
  ExtrudeOptions options;
  options.direction = Vec3(0, height / layers, 0);
  for (std::uint32_t k = 0; k < layers; ++k) {
    std::vector<BundleId> bundles;
    for (const Bundle& bundle : mesh.bundles()) bundles.push_back(bundle.id);
    extrudeFaces(mesh, bundles, options).value();
  }
  return mesh;
}

inline StrandSet strandsOn(const HairMesh& mesh, std::size_t count, std::uint32_t points = 33) {
  GrowOptions options;
  options.count = count, options.points = points;
  return grow(mesh, options).value().strands;
}

inline StyleOperator op(const char* kind, std::map<std::string, double> parameters = {}) {
  StyleOperator out = makeStyleOperator(kind).value();
  for (const auto& [name, value] : parameters) {
    if (!setParameter(out, name, value).ok()) throw std::runtime_error(std::string(kind) + " " + name);
  }
  return out;
}

/// The operator at the same strength from root to tip.
inline StyleOperator level(StyleOperator op) {
  op.ramp = {{{0, 1}}, RampShape::Linear};
  op.amount = 1;
  return op;
}

inline StrandSet styled(const HairMesh& mesh, StrandSet strands, const StyleStack& stack,
                        const StyleOptions& options = {}, int threads = 1) {
  Context context;
  context.threads = threads;
  const auto report = applyStyle(mesh, strands, stack, options, context);
  if (!report.ok()) throw std::runtime_error(report.error().text());
  return strands;
}

inline double lengthOf(std::span<const Vec3f> points) {
  double length = 0;
  for (std::size_t p = 1; p < points.size(); ++p) length += double((points[p] - points[p - 1]).norm());
  return length;
}

inline double greatestDifference(const StrandSet& a, const StrandSet& b) {
  double greatest = 0;
  for (std::size_t p = 0; p < a.points.size(); ++p)
    greatest = std::max(greatest, double((a.points[p] - b.points[p]).norm()));
  return greatest;
}

/// One of every kind, strong enough to be seen, in a fixed order.
inline StyleStack everyKind() {
  StyleStack stack;
  for (const StyleKind& kind : styleKinds()) {
    if (!kind.needsHead) stack.push_back(makeStyleOperator(kind.name).value());
  }
  return stack;
}

}  // namespace coif::samples
