// Hair over the picture: every way of treating what covers a pixel in part.
#pragma once

#include <optional>

#include "preview/eye_layers.h"
#include "preview/fragment_lists.h"
#include "preview/sliced_hair.h"

namespace coif::preview {

/// Programs of a method: of its strands, and of what puts them over the picture.
std::vector<ProgramSource> eyePrograms();

/// The camera as a LightView whose texels are its pixels, for OccupancyOrdered.
LightView viewOfCamera(const View& view);

class EyePass {
 public:
  static Result<EyePass> create(PreviewTransparency method, int width, int height);
  PreviewTransparency method() const { return method_; }
  /// Of one sub-frame, whose head and backdrop are drawn. Errors: TooLarge (lists that do not fit).
  Status draw(const EyeScene& scene) const;

  /// HalfAngleSlices: begin, then a slice after the other, then end.
  void beginSlices(const EyeScene& scene) const;
  void drawSlice(const EyeScene& scene, const SlicedHair& hair, int slice) const;
  void endSlices(const EyeScene& scene) const { compose(scene, "COMPOSE_SLICES"); }

 private:
  ProgramSource strandProgram(const EyeScene& scene, const char* pass) const;
  void drawInPlace(const EyeScene& scene, const char* pass) const;
  void drawHeadDepth(const EyeScene& scene) const;
  void drawWeighted(const EyeScene& scene, const char* pass) const;
  Status drawLists(const EyeScene& scene) const;
  void compose(const EyeScene& scene, const char* pass) const;

  PreviewTransparency method_ = PreviewTransparency::Stochastic;
  int width_ = 0, height_ = 0;
  Texture sum_, transmittance_;
  Renderbuffer depth_;
  Framebuffer own_;
  std::optional<EyeLayers> layers_;
};

}  // namespace coif::preview
