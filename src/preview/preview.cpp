#include "coif/preview/preview.h"

#include "preview/session_impl.h"

namespace coif {

struct Preview::Impl {
  std::shared_ptr<Device> device;
};

Result<Preview> Preview::create() {
  auto device = std::make_shared<Device>();
  COIF_ASSIGN(device->gl, EglContext::create());
  COIF_TRY(device->gl->makeCurrent());
  const CurrentContext current(*device->gl);
  device->programs = std::make_unique<Programs>(allPermutations());
  device->empty = makeVertexArray();
  device->mostBatchPoints = mostBatchPoints();
  device->mostRawPoints = mostRawPoints();
  auto impl = std::make_unique<Impl>();
  impl->device = std::move(device);
  return Preview(std::move(impl));
}

Preview::Preview(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Preview::Preview(Preview&&) noexcept = default;
Preview& Preview::operator=(Preview&&) noexcept = default;
Preview::~Preview() = default;

const std::string& Preview::renderer() const {
  return impl_->device->gl->renderer();
}
bool Preview::software() const {
  return impl_->device->gl->software();
}

PreviewSession::PreviewSession(const Preview& preview) : impl_(std::make_unique<Impl>()) {
  impl_->device = preview.impl_->device;
}

Result<Picture> Preview::render(const PreviewScene& scene, const PreviewOptions& options,
                                const Context& context) {
  const Stopwatch watch;
  PreviewSession session(*this);
  if (scene.head != nullptr) {
    COIF_TRY(validate(*scene.head));
    session.impl_->head =
        std::shared_ptr<const PolygonMesh>(std::shared_ptr<void>(), scene.head);  // not copied
  }
  COIF_TRY(session.setGround(scene.ground));
  if (scene.strands != nullptr) {
    COIF_TRY(scene.grownOn != nullptr
                 ? session.setHair(*scene.grownOn, *scene.strands, scene.knots, 0, context)
                 : session.setStrands(*scene.strands, context));
  }
  if (scene.hairMesh != nullptr) session.setOverlay(*scene.hairMesh);
  session.setCamera(scene.camera);
  session.setLights(scene.lights);
  COIF_ASSIGN(Picture picture, session.render(options, context));
  picture.seconds = watch.seconds();
  return picture;
}

}  // namespace coif
