// The light-oriented density map (Bertails et al. 2005) on the CPU: hair's coverage in cells along the light,
// summed by columns.
//
// A cell's optical depth is κ ds = Σ ℓ D |sin ψ| / ds² over the pieces of hair clipped to it. T lives on the
// face where the light leaves the cell, so that a point in cell k mixes the faces of k − 1 and k along the
// light, and the four cells around it across. Addresses wrap (floor, then modulo) and cells are anchored to
// the scene, so that moving hair uses the same memory and does not flicker against the grid. A point light
// takes cells even in its map's plane and in 1 / depth: straight hairs stay straight there.
#pragma once

#include <memory>
#include <vector>

#include "coif/light/fragments.h"
#include "coif/strands/density_grid.h"

namespace coif {

struct LightDensityOptions {
  int log2Size = 7;   ///< 3 … 9: cells a side
  double cell = 0;    ///< ds, scene units; 0: fits the hair's box. not used by a point light
  bool grows = true;  ///< a cell too small for the hair is doubled until it fits; else TooLarge
};

/// Queries are const and thread-safe.
class LightDensityMap {
 public:
  /// The strands and opacity of `stream`, along its view's light. Errors: InvalidArgument, TooLarge (see
  /// grows), Cancelled.
  static Result<LightDensityMap> make(const FragmentStream& stream, const LightDensityOptions& options = {},
                                      const Context& context = {});
  /// The same for strands that moved, in the same memory; the cell stays unless it has to grow.
  Status update(const FragmentStream& stream, const Context& context = {});

  LightDensityMap(LightDensityMap&&) noexcept;
  LightDensityMap& operator=(LightDensityMap&&) noexcept;
  ~LightDensityMap();

  double transmittance(const Vec3& world) const;
  double cell() const { return cell_; }
  /// Of the grid; a slab's depths for every thread that fills it, 1/16 of a grid of 128³, come on top.
  std::size_t bytes() const { return cells() * sizeof(float); }
  std::size_t droppedStrands() const { return dropped_; }

 private:
  explicit LightDensityMap(const LightDensityOptions& options);
  std::size_t cells() const { return std::size_t(1) << (3 * options_.log2Size); }
  const Vec3& alongRows() const { return rowsAlongRight_ ? view_.right : view_.up; }
  const Vec3& acrossRows() const { return rowsAlongRight_ ? view_.up : view_.right; }
  Vec3 cellsOf(const Vec3& world) const;
  void gather(const FragmentStream& stream, std::size_t begin, std::size_t end, GridPoint* out) const;
  void gatherDistant(const FragmentStream& stream, std::uint64_t first, std::uint64_t last,
                     GridPoint* out) const;
  GridPoint seenFromPoint(const FragmentStream& stream, std::uint32_t point) const;
  void fitCell(const FragmentStream& stream);
  void accumulate(std::size_t begin, std::size_t end);
  float face(long i, long j, long k) const;

  LightView view_;
  LightDensityOptions options_;
  double cell_ = 1;
  bool rowsAlongRight_ = false;  ///< of a distant light's grid, rather than along view.up
  Vec3 low_ = Vec3::Zero();      ///< corner of the hair's box in the light's frame when the map was made
  Vec3 base_ = Vec3::Zero();  ///< whole cells, taken off so that floats stay fine far from the scene's origin
  double inverseNear_ = 1, inverseFar_ = 0;  ///< of a point light's depth
  GridDeposit deposit_;
  struct Aligned {
    void operator()(float* values) const;
  };
  std::unique_ptr<float[], Aligned> values_;  ///< T on the exit faces; slab by slab, GridDeposit::cellInSlab
  class SpareDepths;
  std::unique_ptr<SpareDepths> spare_;
  std::size_t dropped_ = 0;
};

}  // namespace coif
