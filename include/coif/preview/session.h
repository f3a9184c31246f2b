// A picture again and again: an editor's view, a turntable. Keeps on the GPU what did not change.
//
// Hair that grew on a hair mesh is kept as roots and weights; its points are made on the GPU from the mesh's
// vertices (shaders/synthesis.glsl), so moving the mesh uploads the mesh alone. A new camera or light uploads
// no strand data; shadow maps stay while light and hair do.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "coif/preview/preview.h"
#include "coif/strands/catmull_rom.h"
#include "coif/strands/strand_style.h"

namespace coif {

/// Coverage of the strands alone, drawn by a compute shader.
struct ComputeCoverage {
  int width = 0, height = 0;
  std::vector<float> coverage;  ///< height × width, rows from the top; 0 … 1
  double seconds = 0;           ///< of the drawing alone, the GPU waited for; the best of three
};

/// Holds what it shows; nothing it was given needs to live on. Shares the Preview's OpenGL context; use both
/// from one thread at a time.
class PreviewSession {
 public:
  explicit PreviewSession(const Preview& preview);
  PreviewSession(PreviewSession&&) noexcept;
  PreviewSession& operator=(PreviewSession&&) noexcept;
  ~PreviewSession();

  /// Hair grown on `mesh` by grow() with these knots: `strands` carry bundles and weights, and of their
  /// points only the first and last are looked at (place and diameters), so two a strand do. The picture has
  /// at most `points` a strand (0: as many as the longest of `strands`). Styles that moved points are not
  /// seen: setStyle lays them on, or use setStrands. Errors: InvalidArgument where bundles or weights are
  /// missing; those of validate. A strand whose bundle is gone or with a value that is not finite is left out
  /// and counted. Positions agree with StrandSampler's within 1e-5 of the bounding box.
  Status setHair(const HairMesh& mesh, const StrandSet& strands, Knots knots = Knots::Uniform,
                 std::uint32_t points = 0, const Context& context = {});
  /// What styling adds to the strands of setHair (StylePlan::view), in their order; they have as many points
  /// as it from then on. Copied. It follows the mesh wherever moveHair takes it, and is uploaded once; an
  /// empty one takes it off. Where the driver's storage blocks do not hold it, a prefix of the strands is
  /// drawn, wider. Errors: InvalidArgument without setHair, for a style of other strands, of strands of
  /// different numbers of points or that moves roots; what was there is then shown without a style. Positions
  /// agree with StylePlan::apply within 1e-5 of the bounding box.
  Status setStyle(const StrandStyle& style, const Context& context = {});
  /// Strands as they are.
  Status setStrands(const StrandSet& strands, const Context& context = {});
  void clearHair();
  /// New positions for the vertices of setHair's mesh, by index. Roots stay where they are on the head.
  /// Strands of bundles with a vertex that is not finite are left out until it is. Errors: InvalidArgument
  /// for another number of vertices, or without setHair.
  Status moveHair(std::span<const Vec3> positions, const Context& context = {});

  Status setHead(const PolygonMesh& head);  ///< errors: those of validate
  void clearHead();
  Status setGround(std::optional<Ground> ground);  ///< none: nothing to stand on. Errors: those of validate
  void setOverlay(const HairMesh& mesh);  ///< edges and faces drawn over the picture, coloured by layer
  void clearOverlay();
  void setCamera(const Camera& camera);
  void setLights(const Lights& lights);

  /// The picture, and what was uploaded and done for it. Errors: those of Preview::render.
  Result<Picture> render(const PreviewOptions& options = {}, const Context& context = {});

  /// The last picture's strands drawn again without the graphics pipeline: one invocation a segment, 32-bit
  /// atomics (shaders/strand_raster.comp); `nearest`: with the nearest depth too. No head, no shading: what
  /// drawing hairs costs on a device whose pipeline is slower than its compute. Errors: NotFound before the
  /// first picture with hair.
  Result<ComputeCoverage> coverageByCompute(int width, int height, bool nearest = false);

  /// The points of the last picture, as the GPU holds them; strands in the order of their bundles. For tests
  /// and exports. Errors: NotFound before the first picture with hair.
  Result<StrandSet> readBack() const;

 private:
  friend class Preview;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace coif
