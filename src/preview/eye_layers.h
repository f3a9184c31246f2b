// Hair for the eye without the graphics pipeline: a compute shader adds it up in layers of depth behind the
// first hair of each pixel (shaders/eye_layers.glsl). No noise, nothing sorted, the same bytes every time;
// what is lost is the order of hairs within a layer. Where there is no GPU it costs a fraction of what the
// pipeline does.
#pragma once

#include <vector>

#include "preview/eye_scene.h"

namespace coif::preview {

class EyeLayers {
 public:
  EyeLayers(int width, int height);
  /// Over the sub-frame in `scene.targets`, whose head and backdrop are drawn.
  void draw(const EyeScene& scene) const;
  static std::vector<ProgramSource> programs();

 private:
  void addUp(const EyeScene& scene, int firstRow, int endRow) const;
  void compose(const EyeScene& scene, int firstRow, int endRow) const;

  int width_ = 0, height_ = 0, rows_ = 0;  ///< of a band: a driver limits the size of a buffer
  Buffer nearest_, layers_, headDepths_;
};

}  // namespace coif::preview
