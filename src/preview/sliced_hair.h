// Half-angle slices: hair cut across the half vector of light and eye, lit and drawn slice by slice, so that
// each knows the shadow of all before it and the eye sees them in order (Kniss, Premože, Hansen & Ebert 2002,
// for volumes; here for segments).
//
// Error: segments of one slice do not shade each other, and cover each other in the order of the strands;
// both fall with the slices' thickness. Cost: the segments once to the light and once a sub-frame to the eye,
// in as many draws as there are slices.
#pragma once

#include <cstdint>
#include <vector>

#include "coif/light/light_view.h"
#include "preview/frame_data.h"
#include "preview/synthesis.h"

namespace coif::preview {

inline constexpr int kMostSlicesAcross = 1024;

class SlicedHair {
 public:
  /// Sorts the segments of `strands` (ribbons or lines) into slices. Errors: TooLarge for more points than
  /// one buffer of the driver holds.
  static Result<SlicedHair> make(const Programs& programs, const StrandBuffers& strands, const View& view,
                                 const Vec3& towardsLight, const LightView& lightView, const Box& box,
                                 int slices);

  int slices() const { return int(starts_.size()) - 1; }
  bool empty(int slice) const { return starts_[std::size_t(slice)] == starts_[std::size_t(slice) + 1]; }
  /// Light and eye on one side: slices come to the eye front to back, else back to front.
  bool frontToBack() const { return frontToBack_; }
  std::size_t bytes() const;

  /// Lights the ends of a slice's segments with the bound program, strand_shade.comp with SLICED; texture
  /// unit 3 is what the light has passed so far.
  void shade(int slice) const;
  /// Lays a slice on what the light passes.
  void addToLight(const Programs& programs, int slice) const;
  /// A slice with the bound program, strand.vert with SLICED.
  void draw(int slice) const;

  static ProgramSource lightProgram();
  static std::vector<ProgramSource> sortPrograms();

 private:
  GLint first(int slice) const { return GLint(starts_[std::size_t(slice)]); }
  GLsizei count(int slice) const {
    return GLsizei(starts_[std::size_t(slice) + 1] - starts_[std::size_t(slice)]);
  }
  void bind() const;

  const StrandBuffers* strands_ = nullptr;
  bool frontToBack_ = true;
  int lightSize_ = 0;
  std::vector<std::uint32_t> starts_;
  Buffer segments_, shades_;
  Texture light_;
  Framebuffer toLight_;
  VertexArray empty_;
};

}  // namespace coif::preview
