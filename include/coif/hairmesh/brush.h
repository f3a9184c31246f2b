// Brushes: what a stroke over a hair mesh does to its vertices.
//
// A stroke is a line of places in space. It acts as dabs a quarter of the radius apart, so a line drawn on
// leaves its beginning as it was. Topology stays; internal vertices move along and are placed by who cares
// (place.h). Lengths in scene units. Cost: dabs × mesh.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "coif/hairmesh/edit.h"

namespace coif {

enum class BrushKind {
  Comb,     ///< takes hair along and keeps the distance from vertex to vertex, so what hangs below follows
  Grab,     ///< moves what lay under its start by its whole way
  Push,     ///< in, against the mean normal of the hair's outside there
  Pull,     ///< out, along it
  Inflate,  ///< out, each vertex along its own normal; negative strength: in
  Twist,    ///< rolls the hair about its own direction, as a finger does that strokes across it
  Smooth,   ///< relaxes within the layers
};

struct BrushStroke {
  BrushKind kind = BrushKind::Comb;
  std::vector<Vec3> path;  ///< at least one point; Comb, Grab and Twist need two to do anything
  double radius = 1;       ///< > 0
  double strength = 0.5;   ///< −1 … 1; Smooth: 0 … 1
  Falloff falloff = Falloff::Smooth;
  Vec3 through = Vec3::Zero();  ///< unless zero: it reaches all along this direction, not within a ball
  bool roots = false;           ///< the root layer is brushed too
};

/// `mask`: what part of the stroke each vertex takes, by index; empty: all of it. Errors: InvalidArgument;
/// the mesh is then unchanged.
Status brush(HairMesh& mesh, const BrushStroke& stroke, const VertexWeights& mask = {});

/// A stroke while it is being drawn. What comes out is bit for bit what brush() makes of the whole path; a
/// point more costs the dabs that it adds.
class GrowingStroke {
 public:
  /// Errors: as brush().
  static Result<GrowingStroke> begin(const HairMesh& mesh, BrushStroke stroke, VertexWeights mask = {});
  GrowingStroke(GrowingStroke&&) noexcept;
  GrowingStroke& operator=(GrowingStroke&&) noexcept;
  ~GrowingStroke();

  /// Points that go on from the last one. Errors: InvalidArgument for one that is not finite; the stroke is
  /// then as it was.
  Status extend(std::span<const Vec3> points);
  const BrushStroke& stroke() const;  ///< with the path so far
  const VertexWeights& mask() const;
  /// As brush() leaves it. Errors: InvalidArgument where a position is not finite.
  Result<HairMesh> mesh() const;

 private:
  struct Impl;
  explicit GrowingStroke(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace coif
