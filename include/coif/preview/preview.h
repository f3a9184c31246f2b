// Pictures of strands on a head, with or without a window. The only room that knows OpenGL (4.5 core).
//
// Strands are camera-facing ribbons of at least one pixel whose alpha carries the missing width; alpha
// becomes a random sample mask, so nothing is sorted. Each picture is the mean of several sub-frames of four
// samples.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "coif/base/context.h"
#include "coif/base/report.h"
#include "coif/base/result.h"
#include "coif/hairmesh/hair_mesh.h"
#include "coif/light/camera.h"
#include "coif/light/fibre.h"
#include "coif/light/ground.h"
#include "coif/light/image.h"
#include "coif/light/lights.h"
#include "coif/light/visibility.h"
#include "coif/scalp/polygon_mesh.h"
#include "coif/strands/catmull_rom.h"
#include "coif/strands/strand_set.h"

namespace coif {

/// What to show. Pointers may be null and must outlive the call.
struct PreviewScene {
  const StrandSet* strands = nullptr;
  const HairMesh* grownOn =
      nullptr;                   ///< `strands` are as grow() made them on this: the GPU makes their points
  Knots knots = Knots::Uniform;  ///< of grownOn
  const PolygonMesh* head = nullptr;
  std::optional<Ground> ground;
  const HairMesh* hairMesh = nullptr;  ///< drawn over the picture: edges and faces, coloured by layer
  Camera camera;
  Lights lights;
};

/// How a hair scatters light.
enum class PreviewShading {
  Studio,          ///< soft lobes by eye; hair colours as they are, each hair a little different
  KajiyaKay,       ///< light's function of that name
  Marschner,       ///< light's Marschner or Chiang, by `fibre.model`; light through hair is only lost
  DualScattering,  ///< the same with multiple scattering (Zinke et al. 2008)
};

/// What covers a pixel in part. All but Opaque keep a hair's coverage, width over pixel.
enum class PreviewTransparency {
  Auto,              ///< DepthLayers, of one sub-frame, where there is no GPU and no hair is wide;
                     ///< else Stochastic
  Opaque,            ///< as if at least a pixel wide: the depth buffer alone
  Stochastic,        ///< a random part of the samples, right on average
  AlphaToCoverage,   ///< the driver's choice of samples
  WeightedAverage,   ///< mean colour by coverage, exact transmittance: no order at all
  OccupancyOrdered,  ///< weighted by what an occupancy map of the camera says is in front (Sintorn &
                     ///< Assarsson)
  DepthLayers,  ///< optical depth and mean colour in layers behind a pixel's first hair; by compute alone:
                ///< no noise, and a fraction of the others' cost where there is no GPU
  HalfAngleSlices,  ///< lit and composed slice by slice: transparency and the key light's shadow in one
  ExactLists,       ///< all fragments of a pixel, sorted: the truth, and as much memory as that takes
};

/// Deep opacity maps of seven layers, filtered. The GPU's versions have at most 256 slices and 16 layers, 4
/// clusters, 128 occupancy slices in 4 slabs; LightMap takes the grid that fill and rim light have.
inline VisibilityOptions previewVisibility() {
  VisibilityOptions options;
  options.filter = true;
  return options;
}

struct PreviewOptions {
  int width = 1024, height = 1024;                  ///< pixels, 1 … 8192
  int subframes = 4;                                ///< 1 … 64, four samples a pixel each
  Vec3f hairColor = Vec3f(0.085f, 0.036f, 0.016f);  ///< linear RGB where the strands have no colours
  Vec3f headColor = Vec3f(0.50f, 0.40f, 0.34f);
  Vec3f backgroundTop = Vec3f(0.135f, 0.145f, 0.165f), backgroundBottom = Vec3f(0.03f, 0.032f, 0.037f);
  bool transparentBackground = false;  ///< alpha is then the coverage
  PreviewShading shading = PreviewShading::Studio;
  FibreParameters fibre;       ///< of all shadings but Studio
  bool useAbsorption = false;  ///< take fibre.absorption; else hairColor is the colour that dense hair takes
  PreviewTransparency transparency = PreviewTransparency::Auto;
  int halfAngleSlices = 128;  ///< 1 … 1024
  bool leaveOut = true;  ///< skip what cannot be seen in this scene; said in the picture's stages and notes
  bool shadows = true;
  VisibilityOptions visibility = previewVisibility();  ///< of the key light; `opaque` is the scene's head
  bool lod = true;  ///< fewer, wider strands and fewer points where no one could tell
  double strandFraction =
      0;  ///< with lod: part of the strands to draw, 0 … 1; 0: by their width on the screen
  std::size_t maxSegments = 0;  ///< with lod: bound on ribbon segments; 0: by the machine
  bool lines = true;            ///< with lod: hairs thinner than a pixel are lines, at half a ribbon's cost
  bool keep = true;             ///< false: a session makes everything again, as if all had changed
  bool count = false;    ///< texels of shadow maps too (Picture::work), by one more pass over the strands
  bool measure = false;  ///< wait for the GPU after each stage, so that its seconds are its own
};

/// Bytes that went to the GPU for a picture.
struct PreviewUpload {
  std::uint64_t strands = 0;   ///< roots, weights, points that came as points, colours, topology
  std::uint64_t style = 0;     ///< what styling adds to strands on a hair mesh
  std::uint64_t hairMesh = 0;  ///< its vertices
  std::uint64_t head = 0, overlay = 0;
  std::uint64_t plan = 0;   ///< which strands and samples are drawn: by bundle, not by strand
  std::uint64_t frame = 0;  ///< camera, lights and colours
};

/// What a picture asked of the device, counted where it is asked: the same on any machine.
struct PreviewWork {
  std::uint64_t points = 0;       ///< of strands that were made
  std::uint64_t mapSegments = 0;  ///< walked or drawn into shadow maps, in each pass
  std::uint64_t mapTexels = 0;    ///< that these touched, in each pass; with PreviewOptions::count
  std::uint64_t eyeSegments = 0;  ///< walked or drawn for the eye, in each pass of each sub-frame
  std::uint64_t scatterings = 0;  ///< evaluations of a hair's scattering, at most: lights × look-ups × terms
};

struct Picture {
  Image image;
  std::size_t strandsDrawn = 0, segmentsDrawn = 0;
  std::size_t strandsDropped = 0;  ///< values not finite, or fewer than two points
  double widthScale = 1;           ///< by how much the level of detail widened the strands
  double seconds = 0;
  std::vector<std::string> notes;  ///< a sentence each
  PreviewUpload uploaded;
  PreviewWork work;
  std::vector<StageReport> stages;  ///< what ran, what was kept, what was left out, and why
};

/// Owns an OpenGL context of its own; made current on the calling thread during a call and released after.
/// Use one Preview from one thread at a time.
class Preview {
 public:
  /// A context without a window: a GPU through EGL_EXT_platform_device where there is one, else Mesa's
  /// surfaceless platform. COIF_PREVIEW_DEVICE=software skips the GPU. Errors: Unsupported (no EGL, no
  /// OpenGL 4.5).
  static Result<Preview> create();
  Preview(Preview&&) noexcept;
  Preview& operator=(Preview&&) noexcept;
  ~Preview();

  /// One picture, and nothing kept; PreviewSession keeps. Same scene, same options, same machine: same bytes.
  /// Shaders come from the library, or from COIF_SHADER_DIR where that is set, and are compiled when first
  /// used. Errors: InvalidArgument (sizes, camera), Degenerate (a head that fails validate), TooLarge (the
  /// driver's limit), Malformed (a shader does not compile, with its log), NotFound (COIF_SHADER_DIR lacks a
  /// file), Cancelled. Cost without a GPU: some 10 s of processor time for 1024² with 100 000 strands, shared
  /// by the cores.
  Result<Picture> render(const PreviewScene& scene, const PreviewOptions& options = {},
                         const Context& context = {});

  const std::string& renderer() const;  ///< the driver's name for itself
  bool software() const;

 private:
  friend class PreviewSession;
  struct Impl;
  explicit Preview(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace coif
