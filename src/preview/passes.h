// The steps of a picture, one file each; each owns its GL objects and can be replaced alone.
#pragma once

#include <array>
#include <vector>

#include "coif/light/ground.h"
#include "preview/fibre_tables.h"
#include "preview/frame_data.h"
#include "preview/gl_objects.h"
#include "preview/hair_map.h"
#include "preview/light_volume.h"
#include "preview/program.h"
#include "preview/surface_shadow.h"
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

/// A disc lit like the head, with the shadow of head and hair; what shadows it must be bound.
void drawGround(const Programs& programs, const VertexArray& empty, const Ground& ground, double radius,
                const VisibilityOptions& visibility);
/// Its own, or as far as one can make out: a multiple of the scene's size and the eye's distance.
double groundRadius(const Ground& ground, const Box& scene, const Vec3& eye);

/// Places the key light's map over the scene and fills the fields of `frame` that say how it lies.
LightView placeShadowMap(const Box& scene, const Box& hair, int mapSize, FrameData& frame);

/// s of deep opacity layers, from a few strands on a small map.
double chooseLayerSize(const CoarseStrands& hair, const LightView& view, const VisibilityOptions& options,
                       const Context& context);

/// Visibility from the key light (the hair's map beside the head's depth map) and the light volumes. Texture
/// units 0 … 4 as shaders/visibility.glsl names them.
class ShadowPass {
 public:
  /// Fills the volume fields of `frame`, which must be on the GPU already; null strands or head are left out.
  /// `lists`: sorted lists may take the place of a number of layers that is to be chosen. `surfaces`: there
  /// are some on which the hair's shadow falls.
  static Result<ShadowPass> make(const Programs& programs, const LightView& view,
                                 const VisibilityOptions& options, bool lists, const CoarseStrands* strands,
                                 const Fog* fog, const Openness* open, const StrandBuffers* lines,
                                 const HeadBuffers* headBuffers, bool surfaces, FrameData& frame,
                                 const Context& context);
  void bindForHair() const;
  void bindForHead() const;
  const HairMap& map() const { return map_; }

 private:
  void bind(const Texture& volume) const;
  Texture headDepth_, hairOnly_, withHead_;
  HairMap map_;
  SurfaceShadow surface_;
};

/// Every program and permutation that the room can ask for; a test compiles them all.
std::vector<ProgramSource> allPermutations();
ProgramSource headProgram(const VisibilityOptions& visibility, bool studio);
ProgramSource groundProgram(const VisibilityOptions& visibility);
/// What of strand_shade.comp a picture needs.
struct ShadeParts {
  bool shadows = false, tables = false;  ///< without tables: the studio's lobes
  bool multiple = false, grey = false;   ///< with tables
  bool sliced = false;                   ///< half-angle slices, which are lit one by one
};
ProgramSource shadeProgram(const VisibilityOptions& visibility, const ShadeParts& parts);

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
  void clear() const;                             ///< the sum of the sub-frames
  void begin() const;                             ///< binds and clears the sub-frame
  void bind() const;                              ///< the sub-frame
  GLuint depth() const { return depth_.name(); }  ///< of the sub-frame, a multi-sampled texture
  /// `shoulder`: by how much a sample of 1 is compressed; 0 keeps light as it is.
  void accumulate(const Programs& programs, const VertexArray& empty, double shoulder) const;
  Image finish(const Programs& programs, const VertexArray& empty, int subframes) const;

 private:
  int width_ = 0, height_ = 0;
  Texture color_, depth_, sum_, bytes_;
  Framebuffer subframe_, total_, last_;
};

}  // namespace coif::preview
