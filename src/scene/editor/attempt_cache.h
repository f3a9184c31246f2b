// What the attempts of one tool have in common: while the document stays as it is, a drag or a stroke asks
// for nearly the same again and again.
//
// Only ever spares work: with and without it the same bytes come out. Safe from several threads.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "coif/base/context.h"
#include "coif/hairmesh/brush.h"
#include "coif/place/place.h"
#include "coif/scalp/surface.h"

namespace coif::editor {

class AttemptCache {
 public:
  /// Places internal vertices; the matrix is factored once for a topology.
  Status place(HairMesh& mesh, const Context& context);

  /// As coif::brush(); goes on from the last stroke where this one's path does. `revision` is the document's.
  Result<HairMesh> brush(std::uint64_t revision, const HairMesh& mesh, BrushStroke stroke,
                         VertexWeights mask);
  /// As softSelection(), for the same question as the last.
  Result<VertexWeights> soft(std::uint64_t revision, const HairMesh& mesh,
                             std::span<const std::uint32_t> selection, double radius, Falloff falloff,
                             SoftDistance distance);
  /// As coif::editor::pushOut(); vertices that stand where they stood the last time are not asked for again.
  void pushOut(HairMesh& mesh, const Surface& head, std::span<const std::uint32_t> vertices, double margin);

  void forgetHead();

 private:
  struct Pushed {
    Vec3 from, to;
  };
  struct Soft {
    std::uint64_t revision = 0;
    std::vector<std::uint32_t> selection;
    double radius = 0;
    Falloff falloff = Falloff::Smooth;
    SoftDistance distance = SoftDistance::Space;
    VertexWeights weights;
  };
  std::mutex mutex_;
  std::shared_ptr<const Placer> placer_;
  std::optional<GrowingStroke> stroke_;
  std::uint64_t strokeRevision_ = 0;
  std::optional<Soft> soft_;
  std::vector<Pushed> pushed_;  // by vertex; NaN: not known
  const Surface* pushedOutOf_ = nullptr;
  double pushMargin_ = 0;
};

}  // namespace coif::editor
