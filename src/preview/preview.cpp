#include "coif/preview/preview.h"

#include <algorithm>
#include <cmath>

#include "coif/base/report.h"
#include "preview/context_egl.h"
#include "preview/passes.h"

namespace coif {

using namespace preview;

struct Preview::Impl {
  std::unique_ptr<EglContext> gl;
  std::unique_ptr<Programs> programs;
  VertexArray empty;

  ~Impl() {
    if (gl == nullptr || !gl->makeCurrent().ok()) return;
    programs.reset();
    empty = {};
    gl->release();
  }
  Result<Picture> render(const PreviewScene& scene, const PreviewOptions& options, const Context& context);
  Status drawSubframes(const PreviewScene& scene, const PreviewOptions& options, const View& view,
                       FrameData& frame, const StrandGeometry* strands, const Box& box, Picture& picture,
                       const Context& context);
  Status takeErrors(Picture& picture);
};

namespace {

constexpr std::size_t kSoftwareSegments = 450000, kHardwareSegments = 12000000;
constexpr int kSoftwareMap = 1024, kHardwareMap = 2048;

Status checkOptions(const PreviewOptions& options) {
  if (options.width < 1 || options.height < 1 || options.width > 8192 || options.height > 8192) {
    return makeError(ErrorCode::InvalidArgument, "a picture's width and height must lie between 1 and 8192");
  }
  if (options.subframes < 1 || options.subframes > 64) {
    return makeError(ErrorCode::InvalidArgument, "the number of sub-frames must lie between 1 and 64");
  }
  for (const Vec3f* color :
       {&options.hairColor, &options.headColor, &options.backgroundTop, &options.backgroundBottom}) {
    if (!color->allFinite() || color->minCoeff() < 0) {
      return makeError(ErrorCode::InvalidArgument, "colours must be finite and not negative");
    }
  }
  return {};
}

void include(Box& box, bool& any, const Box& other) {
  box.lo = any ? Vec3(box.lo.cwiseMin(other.lo)) : other.lo;
  box.hi = any ? Vec3(box.hi.cwiseMax(other.hi)) : other.hi;
  any = true;
}

Box sceneBox(const PreviewScene& scene) {
  Box box;
  bool any = false;
  if (scene.head != nullptr && !scene.head->positions.empty())
    include(box, any, bounds(scene.head->positions));
  if (scene.strands != nullptr && !scene.strands->points.empty())
    include(box, any, finiteBounds(*scene.strands));
  if (scene.hairMesh != nullptr && !scene.hairMesh->vertices().empty()) {
    std::vector<Vec3> points;
    for (const HairVertex& v : scene.hairMesh->vertices()) points.push_back(v.position);
    include(box, any, bounds(points));
  }
  return box;
}

}  // namespace

Result<Preview> Preview::create() {
  auto impl = std::make_unique<Impl>();
  COIF_ASSIGN(impl->gl, EglContext::create());
  COIF_TRY(impl->gl->makeCurrent());
  const CurrentContext current(*impl->gl);
  Result<Programs> programs = Programs::build();
  if (!programs.ok()) return programs.error();
  impl->programs = std::make_unique<Programs>(std::move(*programs));
  impl->empty = makeVertexArray();
  return Preview(std::move(impl));
}

Preview::Preview(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Preview::Preview(Preview&&) noexcept = default;
Preview& Preview::operator=(Preview&&) noexcept = default;
Preview::~Preview() = default;

const std::string& Preview::renderer() const {
  return impl_->gl->renderer();
}
bool Preview::software() const {
  return impl_->gl->software();
}

Result<Picture> Preview::render(const PreviewScene& scene, const PreviewOptions& options,
                                const Context& context) {
  return impl_->render(scene, options, context);
}

Status Preview::Impl::takeErrors(Picture& picture) {
  for (const std::string& warning : gl->log().warnings) picture.notes.push_back("OpenGL warns: " + warning);
  if (const auto& errors = gl->log().errors; !errors.empty()) {
    return makeError(ErrorCode::Unsupported, "the OpenGL driver reports an error: " + errors.front());
  }
  return {};
}

Result<Picture> Preview::Impl::render(const PreviewScene& scene, const PreviewOptions& options,
                                      const Context& context) {
  const Stopwatch watch;
  COIF_TRY(checkOptions(options));
  if (scene.head != nullptr) COIF_TRY(validate(*scene.head));
  if (scene.strands != nullptr) COIF_TRY(validate(*scene.strands, false));
  const Box box = sceneBox(scene);
  COIF_ASSIGN(const View view, makeView(scene.camera, box, options.width, options.height));

  Picture picture;
  StrandGeometry strands;
  if (scene.strands != nullptr) {
    DetailOptions detail;
    detail.lod = options.lod;
    detail.maxSegments = options.maxSegments > 0 ? options.maxSegments
                         : gl->software()        ? kSoftwareSegments
                                                 : kHardwareSegments;
    strands = makeStrandGeometry(*scene.strands, view, detail, context);
    picture.strandsDrawn = strands.starts.size() - 1;
    picture.segmentsDrawn = strands.segments();
    picture.strandsDropped = strands.dropped;
    picture.widthScale = strands.widthScale;
    if (strands.dropped > 0) {
      picture.notes.push_back(std::to_string(strands.dropped) +
                              " strands were left out: values not finite or fewer than two points");
    }
  }
  if (context.cancelled()) return makeError(ErrorCode::Cancelled, "the picture was cancelled");

  COIF_TRY(gl->makeCurrent());
  const CurrentContext current(*gl);
  gl->log().clear();
  FrameData frame = makeFrame(view, scene.lights, options);
  frame.hairColor.w() = strands.colored ? 1.0f : 0.0f;
  COIF_TRY(drawSubframes(scene, options, view, frame, strands.points.empty() ? nullptr : &strands, box,
                         picture, context));
  COIF_TRY(takeErrors(picture));
  picture.seconds = watch.seconds();
  return picture;
}

Status Preview::Impl::drawSubframes(const PreviewScene& scene, const PreviewOptions& options,
                                    const View& view, FrameData& frame, const StrandGeometry* strands,
                                    const Box& box, Picture& picture, const Context& context) {
  COIF_ASSIGN(const FrameTargets targets, FrameTargets::create(options.width, options.height));
  Buffer frameBuffer = makeBuffer(std::span<const FrameData>(&frame, 1), GL_DYNAMIC_STORAGE_BIT);
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, frameBuffer.name());
  const auto headBuffers = scene.head != nullptr ? std::make_unique<HeadBuffers>(*scene.head) : nullptr;
  const auto strandBuffers = strands != nullptr ? std::make_unique<StrandBuffers>(*strands) : nullptr;
  const auto overlay = scene.hairMesh != nullptr ? std::make_unique<OverlayPass>(*scene.hairMesh) : nullptr;
  const bool shade = options.shadows;
  const ShadowPass shadows(*programs, box, shade ? strands : nullptr, shade ? strandBuffers.get() : nullptr,
                           scene.head, shade ? headBuffers.get() : nullptr, frame, frameBuffer,
                           gl->software() ? kSoftwareMap : kHardwareMap, context);

  for (int k = 0; k < options.subframes; ++k) {
    if (context.cancelled()) return makeError(ErrorCode::Cancelled, "the picture was cancelled");
    frame.clipFromWorld = clipFromWorld(view, subframeJitter(k, options.subframes));
    frame.viewport.z() = float(k);
    glNamedBufferSubData(frameBuffer.name(), 0, sizeof frame, &frame);
    targets.begin();
    if (!options.transparentBackground) {
      glUseProgram((*programs)[ProgramId::Backdrop]);
      glBindVertexArray(empty.name());
      glDrawArrays(GL_TRIANGLES, 0, 3);
    }
    glEnable(GL_DEPTH_TEST);
    if (headBuffers != nullptr) {
      shadows.bindForHead();
      glUseProgram((*programs)[ProgramId::Head]);
      headBuffers->draw();
    }
    if (strandBuffers != nullptr) {
      shadows.bindForHair();
      glUseProgram((*programs)[shade ? ProgramId::Strands : ProgramId::StrandsPlain]);
      strandBuffers->draw();
    }
    if (overlay != nullptr) overlay->draw(*programs);
    targets.accumulate(*programs, empty);
    context.report("picture", double(k + 1) / options.subframes);
  }
  picture.image = targets.finish(*programs, empty, options.subframes);
  return {};
}

}  // namespace coif
