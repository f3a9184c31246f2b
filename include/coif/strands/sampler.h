// Points of strands from their roots: per bundle a small table, per strand one weighted sum.
//
// The spline is linear in its control points and these are Σ λ_i V_i^k, so the curve of a strand is Σ λ_i C_i
// with C_i the spline through column i of its bundle. The C_i are sampled once a bundle; a strand is then
// `corners` scaled arrays added up, which is all the work there is per point.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "coif/base/context.h"
#include "coif/base/result.h"
#include "coif/hairmesh/hair_mesh.h"
#include "coif/strands/catmull_rom.h"
#include "coif/strands/roots.h"

namespace coif {

struct SamplingOptions {
  std::uint32_t points = 32;                       ///< a strand, >= 2, evenly over the spline's parameter
  std::optional<double> tolerance = std::nullopt;  ///< instead: chord error bound in scene units, > 0
  Knots knots = Knots::Uniform;
};

/// Samples strands over one hair mesh; keeps references to the mesh and the roots, which must outlive it. The
/// mesh's positions may move between evaluations (its topology may not); the number of points stays what it
/// was.
///
/// With a tolerance the points of a segment are shared by its bundle: enough for its worst column, which
/// bounds every strand inside (negative weights raise the bound). With root points the first segment is cut a
/// power of two, as often as that strand's lift needs.
class StrandSampler {
 public:
  /// `rootPoints` (one a root, or empty) is where strands must start, for instance on the head. A strand is
  /// moved there by a displacement that fades over its first segment as (1−u)²(1+2u): C¹, the same tangent
  /// direction at the root, every later control point unchanged.
  StrandSampler(const HairMesh& mesh, const RootSet& roots, const SamplingOptions& options,
                std::span<const Vec3f> rootPoints = {}, const Context& context = {});

  std::uint64_t pointCount() const { return offsets_.back(); }
  std::span<const std::uint64_t> offsets() const { return offsets_; }

  /// Writes all points: `points` holds pointCount(). Same bytes for any number of threads; no memory per
  /// strand.
  void evaluate(std::span<Vec3f> points, const Context& context = {}) const;
  /// The same, and diameters that go linearly in the parameter from root to tip; `widths` as long, or empty.
  void evaluate(std::span<Vec3f> points, std::span<float> widths, float rootWidth, float tipWidth,
                const Context& context = {}) const;

  /// Greatest distance, over `samples` strands spread over the set, between the polyline in `points` and the
  /// spline itself sampled 16 times between neighbouring points, in double.
  double chordError(std::span<const Vec3f> points, std::size_t samples) const;

 private:
  class Worker;
  struct Extent {
    std::size_t begin, size;
  };

  template <class Write>
  void forEachStrand(const Context& context, const Write& write) const;
  void planAdaptive(const Context& context);
  std::vector<std::uint32_t> planBundle(std::size_t bundle);
  std::vector<double> intervalsOf(const Bundle& bundle) const;
  Extent extentOf(std::size_t root) const { return {offsets_[root], offsets_[root + 1] - offsets_[root]}; }

  const HairMesh& mesh_;
  const RootSet& roots_;
  SamplingOptions options_;
  std::span<const Vec3f> rootPoints_;
  std::vector<std::uint64_t> offsets_{0};
  std::vector<std::vector<std::uint32_t>> pieces_;  // by bundle, with a tolerance: of its finest strand
};

/// The root of a strand on the cage: Σ λ_i V_i^0, in double.
Vec3 cagePoint(const HairMesh& mesh, const RootSet& roots, std::size_t root);

}  // namespace coif
