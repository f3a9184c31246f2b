// From a hair mesh to strands: roots, curves, widths, ids.
//
// A strand's control point at layer k is Σ λ_i V_i^k with λ the mean value coordinates of its root in the
// root face; a uniform C¹ Catmull–Rom spline with pinned ends runs through them (Yuksel et al. 2009,
// section 3.1).
#pragma once

#include <optional>

#include "coif/base/context.h"
#include "coif/base/report.h"
#include "coif/base/result.h"
#include "coif/hairmesh/hair_mesh.h"
#include "coif/scalp/surface.h"
#include "coif/strands/catmull_rom.h"
#include "coif/strands/strand_set.h"

namespace coif {

struct GrowOptions {
  std::size_t count = 10000;  ///< strands wanted; exactly so many are made while any bundle can grow
  std::uint32_t points = 32;  ///< points a strand, >= 2; ignored with a tolerance
  std::optional<double> tolerance =
      std::nullopt;  ///< chord error bound in scene units: adaptive number of points
  std::uint64_t seed = 1;
  Knots knots = Knots::Uniform;  ///< others are shared per bundle: mean lengths of its columns
  double width = 0;              ///< root diameter in scene units; 0: 0.08 mm by metersPerUnit
  double tipWidth = 0.25;        ///< tip diameter as a fraction of the root's
  double metersPerUnit = 0.01;
  UpAxis upAxis = UpAxis::Y;
  const Surface* head = nullptr;  ///< roots are laid on it, blending over the first segment; may be null
  std::span<const double> density = {};  ///< optional weight a bundle (by index), >= 0
};

struct GrowReport {
  std::size_t negativeWeights = 0;    ///< strands with a negative coordinate (concave root faces)
  std::size_t triangulatedFaces = 0;  ///< self-intersecting projections
  std::size_t barrenBundles = 0;      ///< zero-area root face or height 0: no strands
  std::size_t zeroLength = 0;         ///< strands left out because all their points coincide
  double maxRootLift = 0;             ///< greatest distance from cage to head
  ErrorEstimate error;                ///< chord error of the sampling against the converged spline
  double seconds = 0;
};

struct GrowResult {
  StrandSet strands;
  GrowReport report;
};

/// Errors: InvalidArgument (points < 2, tolerance <= 0, widths negative), Degenerate (no bundle can carry a
/// strand while count > 0), TooLarge, Cancelled. Same bytes for any number of threads.
Result<GrowResult> grow(const HairMesh& mesh, const GrowOptions& options, const Context& context = {});

}  // namespace coif
