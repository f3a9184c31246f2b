#include "coif/preview/session.h"

#include "preview/session_impl.h"

namespace coif {

PreviewSession::Impl::~Impl() {
  withContext([&] {
    dropHair();
    headBuffers.reset(), overlayPass.reset(), shadows.reset(), targets.reset(), fibre.reset();
    eye.reset();
  });
}

void PreviewSession::Impl::dropHair() {
  dropStrands();
  hairBuffers.reset();
}

void PreviewSession::Impl::dropStrands() {
  eyeStrands.reset(), shadowStrands.reset(), shadows.reset();
  eyeLines.reset(), cameraMap.reset(), sliced.reset();
  fog.reset();
}

PreviewSession::PreviewSession(PreviewSession&&) noexcept = default;
PreviewSession& PreviewSession::operator=(PreviewSession&&) noexcept = default;
PreviewSession::~PreviewSession() = default;

Status PreviewSession::setHair(const HairMesh& mesh, const StrandSet& strands, Knots knots,
                               std::uint32_t points, const Context& context) {
  COIF_TRY(validate(strands, false));
  COIF_ASSIGN(PreparedHair hair, prepareGrown(mesh, strands, knots, context));
  if (points == 1) return makeError(ErrorCode::InvalidArgument, "a strand needs at least two points");
  if (points > 1) hair.model.plainPoints = points;
  clearHair();
  impl_->hair = std::move(hair);
  return {};
}

Status PreviewSession::setStrands(const StrandSet& strands, const Context& context) {
  COIF_TRY(validate(strands, false));
  COIF_ASSIGN(PreparedHair hair, prepareImported(strands, impl_->device->mostRawPoints, context));
  clearHair();
  impl_->hair = std::move(hair);
  return {};
}

void PreviewSession::clearHair() {
  impl_->withContext([&] { impl_->dropHair(); });
  impl_->hair.reset(), impl_->style.reset();
  impl_->hairMoved = false;
}

Status PreviewSession::setStyle(const StrandStyle& style, const Context& context) {
  if (!impl_->hair || !impl_->hair->model.synthesised)
    return makeError(ErrorCode::InvalidArgument, "there is no hair on a hair mesh to style");
  HairModel& model = impl_->hair->model;
  if (style.empty() && !model.styled) return {};
  impl_->withContext([&] { impl_->dropStrands(); });
  COIF_ASSIGN(impl_->style, prepareStyle(model, style, impl_->device->mostRawPoints, context));
  return {};
}

Status PreviewSession::moveHair(std::span<const Vec3> positions, const Context&) {
  if (!impl_->hair || !impl_->hair->model.synthesised) {
    return makeError(ErrorCode::InvalidArgument, "there is no hair on a hair mesh to move");
  }
  HairModel& model = impl_->hair->model;
  if (positions.size() != model.mesh.vertices().size()) {
    return makeError(ErrorCode::InvalidArgument, "the hair mesh has " +
                                                     std::to_string(model.mesh.vertices().size()) +
                                                     " vertices, not " + std::to_string(positions.size()));
  }
  model.move(positions);
  impl_->hairMoved = true;
  return {};
}

Status PreviewSession::setHead(const PolygonMesh& head) {
  COIF_TRY(validate(head));
  clearHead();
  impl_->head = std::make_shared<const PolygonMesh>(head);
  return {};
}

void PreviewSession::clearHead() {
  impl_->withContext([&] { impl_->headBuffers.reset(), impl_->shadows.reset(); });
  impl_->fog.reset();
  impl_->head.reset();
}

Status PreviewSession::setGround(std::optional<Ground> ground) {
  if (ground) {
    COIF_TRY(validate(*ground));
    ground->normal = ground->normal.stableNormalized();
  }
  impl_->ground = std::move(ground);
  return {};
}

void PreviewSession::setOverlay(const HairMesh& mesh) {
  clearOverlay();
  impl_->overlay = mesh;
}

void PreviewSession::clearOverlay() {
  impl_->withContext([&] { impl_->overlayPass.reset(); });
  impl_->overlay.reset();
}

void PreviewSession::setCamera(const Camera& camera) {
  impl_->camera = camera;
}
void PreviewSession::setLights(const Lights& lights) {
  impl_->lights = lights;
}

Result<Picture> PreviewSession::render(const PreviewOptions& options, const Context& context) {
  return impl_->render(options, context);
}

Result<StrandSet> PreviewSession::readBack() const {
  if (impl_->eyeStrands == nullptr)
    return makeError(ErrorCode::NotFound, "no picture with hair was made yet");
  COIF_TRY(impl_->device->gl->makeCurrent());
  const CurrentContext current(*impl_->device->gl);
  StrandSet out;
  const bool colored = impl_->hair->model.colored;
  for (const StrandBuffers::Point& p : impl_->eyeStrands->readBack()) {
    out.points.push_back(p.position);
    out.widths.push_back(p.width);
    if (colored) out.colors.push_back(p.color);
  }
  for (const Share& share : impl_->eyeStrands->plan().shares) {
    for (std::uint32_t s = 0; s < share.strands; ++s)
      out.offsets.push_back(out.offsets.back() + share.samples);
  }
  return out;
}

}  // namespace coif
