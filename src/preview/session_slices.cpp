// Half-angle slices in a session: light and eye in turns.
#include "preview/session_impl.h"
#include "preview/stages.h"

namespace coif {

Status PreviewSession::Impl::makeSlices(const PreviewOptions& options, const View& view,
                                        const FrameData& frame, Picture& picture) {
  sliced.reset();
  if (!hair || eye->method() != PreviewTransparency::HalfAngleSlices) return {};
  StageReport& stage = report(picture, "half-angle slices", StageState::Ran, "every picture");
  const StageTimer timer(stage, options.measure);
  COIF_ASSIGN(SlicedHair made, SlicedHair::make(*device->programs, *eyeStrands, view,
                                                frame.lightDirection[0].head<3>().cast<double>(),
                                                shadows->map().view(), box(), options.halfAngleSlices));
  sliced = std::make_unique<SlicedHair>(std::move(made));
  stage.bytes = sliced->bytes();
  stage.notes.push_back(std::string(sliced->frontToBack() ? "front to back" : "back to front") + ", " +
                        std::to_string(sliced->slices()) + " slices");
  return {};
}

// Light does not change between sub-frames: it is worked out in the first.
Status PreviewSession::Impl::drawSlices(const PreviewOptions& options, const EyeScene& scene, bool first) {
  StageReport unused;
  eye->beginSlices(scene);
  for (int s = 0; s < sliced->slices(); ++s) {
    if (sliced->empty(s)) continue;
    if (first) {
      useShading(options, true, unused);
      sliced->shade(s);
    }
    eye->drawSlice(scene, *sliced, s);
    if (first && shadowsHaveHair) sliced->addToLight(scene.programs, s);
  }
  eye->endSlices(scene);
  return {};
}

}  // namespace coif
