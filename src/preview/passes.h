// The steps of a picture, one file each; each owns its GL objects and can be replaced alone.
#pragma once

#include <array>
#include <vector>

#include "preview/frame_data.h"
#include "preview/gl_objects.h"
#include "preview/light_volume.h"
#include "preview/program.h"
#include "preview/synthesis.h"

namespace coif::preview {

inline constexpr int kSamples = 4;  // a pixel and sub-frame; every driver of OpenGL 4.5 has four

/// The head as triangles with smooth normals.
class HeadBuffers {
 public:
  explicit HeadBuffers(const PolygonMesh& head);
  void draw() const;
  std::size_t bytes() const { return bytes_; }

 private:
  std::size_t bytes_ = 0;
  Buffer vertices_, indices_;
  VertexArray array_;
  GLsizei count_ = 0;
};

/// Fills the fields of `frame` that place the key light's map over the scene.
void placeShadowMap(const Box& scene, const Box& hair, int mapSize, FrameData& frame);

/// Visibility from the key light (deep opacity maps of four layers over the head's depth map) and the light
/// volumes. Texture units 0 … 3 as shaders/visibility.glsl names them.
class ShadowPass {
 public:
  /// Fills the shadow and volume fields of `frame`; a null geometry or head is left out.
  ShadowPass(const Programs& programs, const Box& scene, const CoarseStrands* strands,
             const StrandBuffers* buffers, const PolygonMesh* head, const HeadBuffers* headBuffers,
             FrameData& frame, Buffer& frameBuffer, int mapSize, const Context& context);
  void bindForHair() const { bind(withHead_); }
  void bindForHead() const { bind(hairOnly_); }

 private:
  void bind(const Texture& volume) const;
  Texture headDepth_, hairFront_, hairLayers_, hairOnly_, withHead_;
};

/// Edges and faces of the hair mesh, one colour a layer.
class OverlayPass {
 public:
  explicit OverlayPass(const HairMesh& mesh);
  void draw(const Programs& programs) const;
  std::size_t bytes() const { return bytes_; }

 private:
  std::size_t bytes_ = 0;
  Buffer faces_, edges_;
  VertexArray array_;
  GLsizei faceVertices_ = 0, edgeVertices_ = 0;
};

/// Multi-sampled target of a sub-frame, the sum of the sub-frames, and the finished bytes.
class FrameTargets {
 public:
  static Result<FrameTargets> create(int width, int height);
  void clear() const;  ///< the sum of the sub-frames
  void begin() const;  ///< binds and clears the sub-frame
  void accumulate(const Programs& programs, const VertexArray& empty) const;
  Image finish(const Programs& programs, const VertexArray& empty, int subframes) const;

 private:
  int width_ = 0, height_ = 0;
  Texture color_, sum_, bytes_;
  Renderbuffer depth_;
  Framebuffer subframe_, total_, last_;
};

}  // namespace coif::preview
