#include "scene/editor/attempt_cache.h"

#include <algorithm>
#include <limits>

#include "scene/editor/command_table.h"

namespace coif::editor {
namespace {

bool goesOn(const BrushStroke& before, const BrushStroke& now) {
  return before.kind == now.kind && before.radius == now.radius && before.strength == now.strength &&
         before.falloff == now.falloff && before.through == now.through && before.roots == now.roots &&
         before.path.size() <= now.path.size() &&
         std::equal(before.path.begin(), before.path.end(), now.path.begin());
}

}  // namespace

Status AttemptCache::place(HairMesh& mesh, const Context& context) {
  std::shared_ptr<const Placer> own;
  {
    const std::scoped_lock lock(mutex_);
    own = placer_;
  }
  if (!own || !own->fits(mesh)) {
    COIF_ASSIGN(Placer made, Placer::create(mesh, {}, context));
    own = std::make_shared<const Placer>(std::move(made));
    const std::scoped_lock lock(mutex_);
    placer_ = own;
  }
  COIF_ASSIGN(const PlaceReport placed, own->place(mesh, context));
  (void)placed;
  return {};
}

Result<HairMesh> AttemptCache::brush(std::uint64_t revision, const HairMesh& mesh, BrushStroke stroke,
                                     VertexWeights mask) {
  const std::scoped_lock lock(mutex_);
  const bool known =
      stroke_ && strokeRevision_ == revision && stroke_->mask() == mask && goesOn(stroke_->stroke(), stroke);
  if (known) {
    COIF_TRY(stroke_->extend(std::span(stroke.path).subspan(stroke_->stroke().path.size())));
  } else {
    stroke_.reset();
    COIF_ASSIGN(stroke_, GrowingStroke::begin(mesh, std::move(stroke), std::move(mask)));
    strokeRevision_ = revision;
  }
  return stroke_->mesh();
}

Result<VertexWeights> AttemptCache::soft(std::uint64_t revision, const HairMesh& mesh,
                                         std::span<const std::uint32_t> selection, double radius,
                                         Falloff falloff, SoftDistance distance) {
  const std::scoped_lock lock(mutex_);
  const bool known = soft_ && soft_->revision == revision &&
                     std::ranges::equal(soft_->selection, selection) && soft_->radius == radius &&
                     soft_->falloff == falloff && soft_->distance == distance;
  if (!known) {
    soft_.reset();
    COIF_ASSIGN(VertexWeights weights, softSelection(mesh, selection, radius, falloff, distance));
    soft_ =
        Soft{revision, {selection.begin(), selection.end()}, radius, falloff, distance, std::move(weights)};
  }
  return soft_->weights;
}

void AttemptCache::forgetHead() {
  const std::scoped_lock lock(mutex_);
  pushedOutOf_ = nullptr;
}

void AttemptCache::pushOut(HairMesh& mesh, const Surface& head, std::span<const std::uint32_t> vertices,
                           double margin) {
  const std::scoped_lock lock(mutex_);
  if (pushedOutOf_ != &head || pushMargin_ != margin || pushed_.size() != mesh.vertices().size()) {
    const Vec3 unknown = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    pushed_.assign(mesh.vertices().size(), {unknown, unknown});
    pushedOutOf_ = &head, pushMargin_ = margin;
  }
  for (const std::uint32_t v : vertices) {
    if (mesh.position(v) == pushed_[v].from) {
      mesh.setPosition(v, pushed_[v].to);
      continue;
    }
    pushed_[v].from = mesh.position(v);
    editor::pushOut(mesh, head, std::span(&v, 1), margin);
    pushed_[v].to = mesh.position(v);
  }
}

}  // namespace coif::editor
