// Mesh and strands on a frame of hair in motion.
#include "coif/base/random.h"
#include "scene/evaluation_impl.h"

namespace coif {

namespace {

Status hasFrame(const DynamicsCache& motion, std::size_t frame, std::size_t points) {
  if (frame < motion.frameCount() && motion.vertexCount == points) return {};
  return makeError(ErrorCode::InvalidArgument, "the cache has no such frame of this hair mesh",
                   "frame " + std::to_string(frame));
}

}  // namespace

Status Evaluation::Impl::makeWisps(const Scene& scene, const Context& context) {
  const DynamicsSettings& s = scene.dynamics;
  std::uint64_t key = hashCombine(placedHash, head ? hashCombine(1, headHash) : 0);
  for (const std::uint64_t part : {std::uint64_t(s.wisps), std::uint64_t(s.guidePoints), s.seed})
    key = hashCombine(key, part);
  if (wisps && wisps->key == key) return {};
  wisps.reset();
  COIF_ASSIGN(WispSet made, coif::makeWisps(placed, {s.wisps, s.guidePoints, s.seed}, head.get(), context));
  wisps = Wisps{key, std::move(made), {}, {}};
  return {};
}

Result<std::size_t> Evaluation::movedPoints(const Scene& scene, const Context& context) {
  COIF_ASSIGN(const HairMesh* placed, placedMesh(scene, context));
  if (scene.dynamics.wisps == 0) return placed->vertices().size();
  COIF_TRY(impl_->makeWisps(scene, context));
  return impl_->wisps->set.guides.size();
}

/// The strands at rest, styled, taken along by their wisps.
Result<StrandSet> Evaluation::Impl::carried(const Scene& scene, const DynamicsCache& cache, std::size_t frame,
                                            const Context& context) {
  COIF_TRY(makeWisps(scene, context));
  COIF_TRY(hasFrame(cache, frame, wisps->set.guides.size()));
  Scene asked = scene;
  asked.strands.tolerance = 0;
  COIF_TRY(growStrands(asked, context));
  COIF_TRY(style(asked, context));
  Context whole = context;
  whole.cancel = nullptr;  // half of the strands would be none
  const std::uint64_t boundKey = hashCombine(*strandsKey, styleKey.value_or(0));
  if (wisps->boundKey != boundKey) {
    wisps->bound = bindStrands(wisps->set, strands(), whole);
    wisps->boundKey = boundKey;
  }
  std::vector<Vec3> positions;
  for (const Vec3f& p : cache.frame(frame)) positions.push_back(p.cast<double>());
  StrandSet moved = strands();
  COIF_TRY(carryStrands(wisps->set, positions, cache.poses[frame].rotation, wisps->bound, moved, whole));
  return moved;
}

Result<HairMesh> Evaluation::meshAt(const Scene& scene, const DynamicsCache& motion, std::size_t frame,
                                    const Context& context) {
  if (scene.dynamics.wisps > 0)
    return makeError(ErrorCode::InvalidArgument, "hair that moves in wisps has strands on a frame, no mesh");
  COIF_ASSIGN(const HairMesh* placed, placedMesh(scene, context));
  COIF_TRY(hasFrame(motion, frame, placed->vertices().size()));
  const RigidPose pose = motion.poses[frame];
  HairMesh mesh = *placed;
  for (std::uint32_t v = 0; v < motion.vertexCount; ++v) {
    const Vec3 local = pose.local(motion.frame(frame)[v].cast<double>());
    // Roots rest in the head's frame but for float rounding; a scalp that deforms moves them further.
    const bool rests = mesh.vertices()[v].layer == 0 &&
                       (local - mesh.position(v)).norm() < 1e-5 * (1 + local.norm() + pose.position.norm());
    if (!rests) mesh.setPosition(v, local);
  }
  return mesh;
}

Result<StrandSet> Evaluation::strandsAt(const Scene& scene, const DynamicsCache& motion, std::size_t frame,
                                        const Context& context) {
  if (scene.dynamics.wisps > 0) {
    COIF_TRY(impl_->loadHead(scene, context));
    COIF_TRY(impl_->runPlace(scene, context));
    return impl_->carried(scene, motion, frame, context);
  }
  COIF_ASSIGN(const HairMesh mesh, meshAt(scene, motion, frame, context));
  const RigidPose pose = motion.poses[frame];
  Scene asked = scene;
  asked.strands.tolerance = 0;
  COIF_ASSIGN(GrowResult grown, grow(mesh, growOptions(asked, impl_->head.get()), context));
  COIF_ASSIGN(const StylePlan* style, impl_->styleForMotion(scene, context));
  COIF_TRY(style->apply(mesh, grown.strands, context));
  for (Vec3f& p : grown.strands.points) p = pose.world(p.cast<double>()).cast<float>();
  return std::move(grown.strands);
}

}  // namespace coif
