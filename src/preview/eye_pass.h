// Hair over the picture: every way of treating what covers a pixel in part.
#pragma once

#include <optional>

#include "preview/fragment_lists.h"
#include "preview/hair_map.h"
#include "preview/passes.h"

namespace coif::preview {

/// What is drawn, and over what.
struct EyeScene {
  const Programs& programs;
  const StrandBuffers& strands;  ///< ribbons, or lines
  const HeadBuffers* head;       ///< may be null
  const HairMap* cameraMap;      ///< OccupancyOrdered: what lies in front, seen from the camera
  const FrameTargets& targets;
  const VertexArray& empty;
};

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
};

}  // namespace coif::preview
