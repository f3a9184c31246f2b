// What the hair leaves of the key light on the first surface behind it: a texture for head and ground
// (shaders/surface_shadow.comp).
#pragma once

#include "preview/hair_map.h"

namespace coif::preview {

class SurfaceShadow {
 public:
  SurfaceShadow() = default;  ///< none
  /// Of the map that is bound, over the head's depths from the light. `spread`: standard deviation of the
  /// smoothing in the scene's units. The frame's block must be on the GPU.
  SurfaceShadow(const Programs& programs, const HairMap& map, const Texture& headDepth, double spread);
  void bind() const;  ///< texture unit 8
  static std::vector<ProgramSource> programs();
  /// True where a surface looks this texture up, rather than no map or the light volume.
  static bool usedBy(const VisibilityOptions& options);

 private:
  Texture light_;
};

}  // namespace coif::preview
