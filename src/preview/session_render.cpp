#include <algorithm>
#include <cmath>
#include <tuple>

#include "preview/session_impl.h"
#include "preview/stages.h"

namespace coif {
namespace {

constexpr double kSoftwareSegments = 450000, kHardwareSegments = 12000000;  // of a picture of 512²
constexpr int kMapSize =
    1024;  // finer ones resolve single hairs, which few layers cannot follow (docs/visibility.md)

Status checkOptions(const PreviewOptions& options) {
  if (options.width < 1 || options.height < 1 || options.width > 8192 || options.height > 8192) {
    return makeError(ErrorCode::InvalidArgument, "a picture's width and height must lie between 1 and 8192");
  }
  if (options.subframes < 1 || options.subframes > 64) {
    return makeError(ErrorCode::InvalidArgument, "the number of sub-frames must lie between 1 and 64");
  }
  if (!(options.strandFraction >= 0 && options.strandFraction <= 1)) {
    return makeError(ErrorCode::InvalidArgument, "the fraction of strands must lie between 0 and 1");
  }
  if (options.halfAngleSlices < 1 || options.halfAngleSlices > kMostSlicesAcross) {
    return makeError(ErrorCode::InvalidArgument,
                     "the number of half-angle slices must lie between 1 and 1024");
  }
  if (options.shadows) COIF_TRY(checkMapOptions(options.visibility));
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

Box finiteBox(const HairMesh& mesh) {
  std::vector<Vec3> points;
  for (const HairVertex& v : mesh.vertices()) {
    if (v.position.allFinite()) points.push_back(v.position);
  }
  return points.empty() ? Box{} : bounds(points);
}

std::size_t mostSegments(const PreviewOptions& options, const Device& device, double part) {
  if (options.maxSegments > 0) return std::size_t(std::min(part, 1.0) * double(options.maxSegments));
  return std::size_t(device.gl->software() ? part * kSoftwareSegments
                                           : std::min(part, 1.0) * kHardwareSegments);
}

DetailOptions detailOf(const PreviewOptions& options, const Device& device) {
  DetailOptions detail;
  detail.lod = options.lod;
  detail.fraction = options.strandFraction;
  // Mesa draws but half of a multi-sampled line that lies along an axis, or nearly so.
  const PreviewTransparency method = options.transparency;
  const bool samples = method == PreviewTransparency::Opaque || method == PreviewTransparency::Stochastic ||
                       method == PreviewTransparency::AlphaToCoverage;
  detail.lines = options.lod && options.lines && !(samples && device.gl->software());
  detail.batchPoints = device.mostBatchPoints;
  // In a large picture so few strands would show as wires.
  const double larger = std::clamp(std::sqrt(double(options.width) * options.height) / 512, 1.0, 3.0);
  detail.maxSegments = mostSegments(options, device, larger);
  return detail;
}

// A hair in the map is a texel wide, and nothing looks at a map from near.
DetailOptions mapDetailOf(const PreviewOptions& options, const Device& device) {
  DetailOptions detail = detailOf(options, device);
  detail.tolerancePx = 0.7;
  detail.ribbonPx = 1;
  detail.longestPx = 64;
  detail.maxSegments = mostSegments(options, device, 0.5);
  return detail;
}

bool sameLight(const FrameData& a, const FrameData& b) {
  for (int l = 0; l < 3; ++l) {
    if (a.lightDirection[l] != b.lightDirection[l]) return false;
  }
  return a.viewUp == b.viewUp;
}

bool sameMap(const VisibilityOptions& a, const VisibilityOptions& b) {
  const auto key = [](const VisibilityOptions& o) {
    return std::tuple(o.method, o.slices, o.layers, o.bound, o.sizes, o.past, o.layerSize, o.filter);
  };
  return key(a) == key(b);
}

std::string strandsText(const DetailPlan& plan) {
  return std::to_string(plan.strands) + " strands, " + std::to_string(plan.points) + " points";
}

}  // namespace

Box PreviewSession::Impl::box() const {
  Box box;
  bool any = false;
  if (head != nullptr && !head->positions.empty()) include(box, any, bounds(head->positions));
  if (hair && !hair->model.coarse.points.empty()) {
    include(box, any, hair->model.coarse.box);
    if (hair->model.synthesised) include(box, any, finiteBox(hair->model.mesh));
  }
  if (overlay && !overlay->vertices().empty()) include(box, any, finiteBox(*overlay));
  return box;
}

// No map is made of the ground, so it is in the camera's range alone, and no farther than one can see.
Box PreviewSession::Impl::seenBox() const {
  Box seen = box();
  bool any = seen.diagonal() > 0;
  if (ground) {
    const double radius = groundRadius(*ground, seen, camera.eye);
    const Vec3 reach =
        radius * (Vec3::Ones() - ground->normal.cwiseAbs2()).cwiseMax(0).cwiseSqrt();  // of a disc, by axis
    include(seen, any, {ground->point - reach, ground->point + reach});
  }
  return seen;
}

void PreviewSession::Impl::upload(Picture& picture) {
  if (head != nullptr && headBuffers == nullptr) {
    headBuffers = std::make_unique<HeadBuffers>(*head);
    picture.uploaded.head = headBuffers->bytes();
  }
  if (overlay && overlayPass == nullptr) {
    overlayPass = std::make_unique<OverlayPass>(*overlay);
    picture.uploaded.overlay = overlayPass->bytes();
  }
  if (!hair) return;
  const bool first = hairBuffers == nullptr;
  if (first) {
    hairBuffers = std::make_unique<HairBuffers>(hair->model, hair->upload);
    picture.uploaded.strands = hairBuffers->bytes();
    hair->upload = {};
  }
  if (style) {
    picture.uploaded.style = hairBuffers->setStyle(*style);
    style.reset();
  }
  if (hair->model.synthesised && (first || hairMoved)) {
    picture.uploaded.hairMesh = hairBuffers->move(hair->model);
    eyeOld = shadowOld = eyeLinesOld = true;
    fog.reset();
  }
  hairMoved = false;
  report(picture, "hair", first ? StageState::Ran : StageState::Reused,
         first ? "new strands" : "the strands' roots did not change", picture.uploaded.strands);
}

void PreviewSession::Impl::follow(std::unique_ptr<StrandBuffers>& strands, bool& old, DetailPlan plan,
                                  const char* name, const PreviewOptions& options, Topology topology,
                                  Picture& picture) {
  const bool same = strands != nullptr && strands->plan() == plan;
  if (options.keep && same && !old) {
    report(picture, name, StageState::Reused, "the same strands with the same points: " + strandsText(plan));
    return;
  }
  StageReport& stage = report(picture, name, StageState::Ran,
                              strands == nullptr ? "first picture"
                              : !same            ? "another level of detail"
                              : old              ? "the hair mesh moved"
                                                 : "asked for");
  const StageTimer timer(stage, options.measure);
  stage.notes.push_back(strandsText(plan));
  if (same) {
    strands->make(hair->model, *hairBuffers, *device->programs);
  } else {
    picture.uploaded.plan += plan.bytes();
    strands.reset();  // first, so that both need not fit
    strands = std::make_unique<StrandBuffers>(hair->model, *hairBuffers, *device->programs, std::move(plan),
                                              topology);
  }
  stage.bytes = strands->bytes();
  picture.work.points += strands->plan().points;
  old = false;
}

void PreviewSession::Impl::makeEyeStrands(const PreviewOptions& options, const View& view, Picture& picture,
                                          const Context& context) {
  const PixelSize pixelAt = [&](const Vec3& p) { return view.pixelAt(p); };
  DetailPlan plan = makePlan(hair->model, detailOf(options, *device), pixelAt, context);
  picture.strandsDrawn = plan.strands;
  picture.segmentsDrawn = plan.segments();
  picture.widthScale = plan.widthScale;
  picture.strandsDropped = hair->model.dropped + hair->model.hidden();
  if (picture.strandsDropped > 0) {
    picture.notes.push_back(std::to_string(picture.strandsDropped) +
                            " strands were left out: values not finite or fewer than two points");
  }
  const Topology topology = plan.lines ? Topology::Lines : Topology::Ribbons;
  follow(eyeStrands, eyeOld, std::move(plan), "strands for the eye", options, topology, picture);
}

void PreviewSession::Impl::makeShadowStrands(const PreviewOptions& options, const FrameData& frame,
                                             Picture& picture, const Context& context) {
  const double texel = frame.shadowInfo.z();
  shadowDetail = mapDetailOf(options, *device);
  DetailPlan plan = makePlan(
      hair->model, shadowDetail, [texel](const Vec3&) { return texel; }, context);
  follow(shadowStrands, shadowOld, std::move(plan), "strands for the maps", options, Topology::Segments,
         picture);
}

const Fog& PreviewSession::Impl::theFog() {
  if (fog == nullptr) {
    fog = std::make_unique<Fog>(makeFog(hair->model.coarse, head.get()));
    openness.reset();
  }
  return *fog;
}

Status PreviewSession::Impl::makeShadows(const PreviewOptions& options, FrameData& frame, Buffer& frameBuffer,
                                         Picture& picture, const Context& context) {
  const bool withHair = hair && options.shadows;
  VisibilityOptions visibility = options.visibility;
  const bool dark = withHair && options.leaveOut && lights.key.color.isZero(0);
  if (dark) visibility.method = VisibilityMethod::None;
  const VisibilityMethod method = visibility.method;
  const bool needsLines = method != VisibilityMethod::None && method != VisibilityMethod::LightMap;
  const bool otherLines =
      needsLines && (shadowStrands == nullptr || shadowOld || shadowDetail != mapDetailOf(options, *device));
  const bool moved = withHair && (otherLines || fog == nullptr);
  const bool light = sameLight(frame, shadowFrame);
  const bool surfaces = headBuffers != nullptr || ground;
  if (options.keep && shadows != nullptr && !moved && light && shadowsHaveHair == withHair &&
      (shadowsOnSurfaces || !surfaces) && sameMap(visibility, shadowOptions)) {
    copyShadowFields(shadowFrame, frame);
    write(frameBuffer, &frame, sizeof frame);
    report(picture, "shadow maps", withHair ? StageState::Reused : StageState::Skipped,
           withHair ? "light and hair did not move" : "no hair, or shadows are off");
    return {};
  }

  const LightView lightView = placeShadowMap(box(), hair ? hair->model.coarse.box : box(), kMapSize, frame);
  if (withHair && needsLines) makeShadowStrands(options, frame, picture, context);
  StageReport& stage = report(picture, "shadow maps", withHair ? StageState::Ran : StageState::Skipped,
                              !withHair            ? "no hair, or shadows are off"
                              : shadows == nullptr ? "first picture"
                              : moved              ? "the hair moved, or its detail changed"
                              : !light             ? "the light moved"
                                                   : "asked for");
  const StageTimer timer(stage, options.measure);
  shadows.reset();
  write(frameBuffer, &frame, sizeof frame);
  const Vec3 up = frame.viewUp.head<3>().cast<double>();
  if (withHair && (fog == nullptr || openness == nullptr || openness->up != up))
    openness = std::make_unique<Openness>(openSides(theFog(), up, context));
  COIF_ASSIGN(ShadowPass made,
              ShadowPass::make(*device->programs, lightView, visibility, options.leaveOut,
                               withHair ? &hair->model.coarse : nullptr, withHair ? fog.get() : nullptr,
                               openness.get(), withHair && needsLines ? shadowStrands.get() : nullptr,
                               options.shadows ? headBuffers.get() : nullptr, surfaces, frame, context));
  shadows = std::make_unique<ShadowPass>(std::move(made));
  if (withHair && needsLines) COIF_TRY(countMapWork(options, picture));
  stage.bytes = shadows->map().bytes();
  if (dark) stage.notes.push_back("the key light is dark: no map");
  if (!shadows->map().choice().empty()) stage.notes.push_back(shadows->map().choice());
  shadowFrame = frame;
  shadowsHaveHair = withHair;
  shadowsOnSurfaces = surfaces;
  shadowOptions = visibility;
  return {};
}

Status PreviewSession::Impl::countMapWork(const PreviewOptions& options, Picture& picture) {
  picture.work.mapSegments = shadowStrands->takeWalked();
  const std::uint64_t once = shadowStrands->plan().segments();
  if (!options.count || once == 0) return {};
  COIF_ASSIGN(const std::uint64_t touched, shadows->map().texelsTouched(*device->programs, *shadowStrands));
  picture.work.mapTexels = touched * (picture.work.mapSegments / once);
  shadowStrands->takeWalked();
  return {};
}

Result<Picture> PreviewSession::Impl::render(const PreviewOptions& asked, const Context& context) {
  constexpr int kEnoughOfLayers = 1;
  const Stopwatch watch;
  COIF_TRY(checkOptions(asked));
  PreviewOptions options = asked;
  if (asked.transparency == PreviewTransparency::HalfAngleSlices)
    options.visibility.method = VisibilityMethod::None;  // the slices are the map
  if (hair) hair->model.follow(context);
  COIF_ASSIGN(const View view, makeView(camera, seenBox(), options.width, options.height));
  if (context.cancelled()) return makeError(ErrorCode::Cancelled, "the picture was cancelled");
  COIF_TRY(device->gl->makeCurrent());
  const CurrentContext current(*device->gl);
  device->gl->log().clear();
  Picture picture;
  upload(picture);
  if (hair) makeEyeStrands(options, view, picture, context);
  FrameData frame = makeFrame(view, lights, options);
  frame.hairColor.w() = hair && hair->model.colored ? 1.0f : 0.0f;
  Buffer frameBuffer = makeBuffer(std::span<const FrameData>(&frame, 1), GL_DYNAMIC_STORAGE_BIT);
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, frameBuffer.name());
  COIF_TRY(makeShadows(options, frame, frameBuffer, picture, context));
  write(frameBuffer, &frame, sizeof frame);  // with what the maps filled in
  COIF_TRY(makeEye(options, view, picture));
  COIF_TRY(makeSlices(options, view, frame, picture));
  if (hair && options.leaveOut && options.transparency == PreviewTransparency::Auto &&
      eye->method() == PreviewTransparency::DepthLayers && options.subframes > kEnoughOfLayers) {
    options.subframes = kEnoughOfLayers;
    report(picture, "more sub-frames", StageState::Skipped, "depth layers have no noise: one does");
  }
  shade(asked, picture);
  COIF_TRY(draw(options, view, frame, frameBuffer, picture, context));
  COIF_TRY(device->programs->error());
  for (const std::string& warning : device->gl->log().warnings)
    picture.notes.push_back("OpenGL warns: " + warning);
  if (const auto& errors = device->gl->log().errors; !errors.empty()) {
    return makeError(ErrorCode::Unsupported, "the OpenGL driver reports an error: " + errors.front());
  }
  picture.uploaded.frame += sizeof frame * std::size_t(options.subframes + 1);
  picture.seconds = watch.seconds();
  return picture;
}

}  // namespace coif
