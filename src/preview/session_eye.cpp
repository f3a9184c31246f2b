// A session's picture as the eye sees it: how hair is lit and made transparent, and the sub-frames.
#include <algorithm>
#include <cmath>

#include "preview/session_impl.h"
#include "preview/stages.h"

namespace coif {

namespace {

constexpr int kMostLookUps = 2;  // of the key light's map a point; hairs that overlap make the mean of more

int lookUpsOf(const PreviewOptions& options) {
  return std::min(options.subframes, kMostLookUps);
}

/// Evaluations of a hair's scattering for one light, as shaders/fibre_tables.glsl makes them: alone, and with
/// multiple scattering from behind as well, and both again for scattered light, by channel.
std::uint64_t scatteringTerms(const ShadeParts& parts) {
  return !parts.multiple ? 1 : parts.grey ? 4 : 8;
}

}  // namespace

void PreviewSession::Impl::shade(const PreviewOptions& options, Picture& picture) {
  if (!hair) return;
  StageReport& stage = report(picture, "shading", StageState::Ran, "light, hair or camera may have moved");
  const StageTimer timer(stage, options.measure);
  if (sliced) {
    stage.state = StageState::Skipped;
    stage.reason = "half-angle slices are lit as they are drawn";
    return;
  }
  const ShadeParts parts = useShading(options, false, stage);
  eyeStrands->dispatchPoints();
  eyeStrands->takeWalked();
  const std::uint64_t lookUps = std::uint64_t(lookUpsOf(options)) + 2;
  picture.work.scatterings = eyeStrands->plan().points * lookUps * scatteringTerms(parts);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

ShadeParts PreviewSession::Impl::useShading(const PreviewOptions& options, bool slices, StageReport& stage) {
  const bool tables = options.shading != PreviewShading::Studio;
  if (tables) {
    const FibreParameters wanted = fibreOf(options);
    if (fibre == nullptr || !sameFibre(fibre->fibre(), wanted)) fibre = std::make_unique<FibreTables>(wanted);
    fibre->bind();
  }
  const bool multiple = options.shading == PreviewShading::DualScattering;
  hairPasses = multiple ? fibre->forwardAcross() : Vec3f(Vec3f::Zero());
  const bool grey = tables && options.leaveOut && fibre->grey();
  if (grey) stage.notes.push_back("grey hair: one channel");
  shadows->bindForHair();
  const ShadeParts parts{shadowsHaveHair, tables, multiple, grey, slices};
  glUseProgram((*device->programs)(shadeProgram(shadows->map().options(), parts)));
  glUniform1i(1, lookUpsOf(options));
  return parts;
}

Status PreviewSession::Impl::makeEye(const PreviewOptions& options, const View& view, Picture& picture) {
  if (!hair) return {};
  const PreviewTransparency method = chooseTransparency(options, view, picture);
  if (eye == nullptr || eye->method() != method || targetWidth != options.width ||
      targetHeight != options.height) {
    eye.reset();
    COIF_ASSIGN(EyePass made, EyePass::create(method, options.width, options.height));
    eye = std::make_unique<EyePass>(std::move(made));
  }
  cameraMap.reset();
  if (method == PreviewTransparency::DepthLayers) {
    constexpr double kFirstLayer = 0.25;  // optical depths: eight linear layers then reach nine
    eyeLayerSize = kFirstLayer / std::max(meanExtinction(theFog()), 1e-3 / box().diagonal());
  }
  if (method != PreviewTransparency::OccupancyOrdered) return {};
  follow(eyeLines, eyeLinesOld, eyeStrands->plan(), "strands for the camera's map", options,
         Topology::Segments, picture);
  StageReport& stage = report(picture, "camera's map", StageState::Ran, "every picture");
  const StageTimer timer(stage, options.measure);
  VisibilityOptions occupancy;
  occupancy.method = VisibilityMethod::Occupancy;
  COIF_ASSIGN(HairMap map,
              HairMap::make(*device->programs, eyeLines.get(), viewOfCamera(view), 1, occupancy));
  cameraMap = std::make_unique<HairMap>(std::move(map));
  stage.bytes = cameraMap->bytes();
  return {};
}

PreviewTransparency PreviewSession::Impl::chooseTransparency(const PreviewOptions& options, const View& view,
                                                             Picture& picture) const {
  if (options.leaveOut && options.transparency != PreviewTransparency::Opaque && leastCoverage(view) >= 1) {
    report(picture, "transparency", StageState::Skipped,
           "every hair is wider than a pixel: the depth buffer decides");
    return PreviewTransparency::Opaque;
  }
  if (options.transparency != PreviewTransparency::Auto) return options.transparency;
  const bool layers = device->gl->software() && eyeStrands->plan().thin;
  return layers ? PreviewTransparency::DepthLayers : PreviewTransparency::Stochastic;
}

// Of a pixel by the thinnest of the coarse strands' points, without the ribbon's own widening.
double PreviewSession::Impl::leastCoverage(const View& view) const {
  double least = INFINITY;
  const CoarseStrands& coarse = hair->model.coarse;
  for (const CoarseStrands::Point& p : coarse.points) {
    least = std::min(least, double(p.width) / view.pixelAt(p.position.cast<double>()));
  }
  return least * eyeStrands->plan().widthScale / std::max(coarse.scale, 1e-300);
}

Status PreviewSession::Impl::drawSubframe(const PreviewOptions& options, const View& view, bool first) {
  constexpr double kShoulder = 0.25;
  const Programs& programs = *device->programs;
  const bool studio = options.shading == PreviewShading::Studio;
  targets->begin();
  if (!options.transparentBackground) {
    glUseProgram(programs[ProgramId::Backdrop]);
    glBindVertexArray(device->empty.name());
    glDrawArrays(GL_TRIANGLES, 0, 3);
  }
  glEnable(GL_DEPTH_TEST);
  if (headBuffers != nullptr) {
    shadows->bindForHead();
    glUseProgram(programs(headProgram(shadows->map().options(), studio)));
    headBuffers->draw();
  }
  if (ground) {
    shadows->bindForHead();
    drawGround(programs, device->empty, *ground, groundRadius(*ground, box(), camera.eye),
               shadows->map().options());
  }
  if (hair) {
    const EyeScene scene{programs,      *eyeStrands, headBuffers.get(), cameraMap.get(), *targets,
                         device->empty, view,        eyeLayerSize};
    COIF_TRY(sliced ? drawSlices(options, scene, first) : eye->draw(scene));
  }
  if (overlayPass != nullptr) overlayPass->draw(programs);
  targets->accumulate(programs, device->empty, studio ? kShoulder : 0);
  return {};
}

Status PreviewSession::Impl::draw(const PreviewOptions& options, const View& view, FrameData& frame,
                                  Buffer& frameBuffer, Picture& picture, const Context& context) {
  if (targets == nullptr || targetWidth != options.width || targetHeight != options.height) {
    targets.reset();
    COIF_ASSIGN(FrameTargets made, FrameTargets::create(options.width, options.height));
    targets = std::make_unique<FrameTargets>(std::move(made));
    targetWidth = options.width, targetHeight = options.height;
  }
  targets->clear();
  StageReport& stage = report(picture, "picture", StageState::Ran, "every picture is drawn");
  const StageTimer timer(stage, options.measure);
  for (int k = 0; k < options.subframes; ++k) {
    if (context.cancelled()) return makeError(ErrorCode::Cancelled, "the picture was cancelled");
    frame.clipFromWorld = clipFromWorld(view, subframeJitter(k, options.subframes));
    frame.viewport.z() = float(k);
    frame.hairPasses.head<3>() = hairPasses;
    write(frameBuffer, &frame, sizeof frame);
    COIF_TRY(drawSubframe(options, view, k == 0));
    context.report("picture", double(k + 1) / options.subframes);
  }
  if (hair) picture.work.eyeSegments = eyeStrands->takeWalked();
  picture.image = targets->finish(*device->programs, device->empty, options.subframes);
  return {};
}

}  // namespace coif
