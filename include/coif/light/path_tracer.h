// The truth: every way that light takes between the hairs, followed at random.
//
// Unbiased but for paths of more than `maxBounces` fibres, which are counted: next-event estimation, multiple
// importance sampling of image surroundings (Veach 1997, power heuristic), Russian roulette by throughput. A
// fibre is a thin scatterer of the StrandSet's own polyline, round, with the width between points linear: a
// ray meets it as strand_shooter.h says, is scattered by FibreScattering at the offset h it was met at, and
// goes on from there, leaving out the fibre's own passage, which that function accounts for.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "coif/base/context.h"
#include "coif/base/result.h"
#include "coif/light/camera.h"
#include "coif/light/fibre.h"
#include "coif/light/ground.h"
#include "coif/light/image.h"
#include "coif/light/lights.h"
#include "coif/scalp/polygon_mesh.h"
#include "coif/strands/strand_set.h"

namespace coif {

/// What to look at. Pointers may be null and must outlive the call. Head and ground are diffuse; the head is
/// shaded smoothly, and both sides alike.
struct PathTraceScene {
  const StrandSet* strands = nullptr;
  const PolygonMesh* head = nullptr;
  std::optional<Ground> ground;
  Camera camera;
  Lights lights;
  FibreParameters fibre;
  /// Strands with colours take the absorption of their mean colour (absorptionFromAlbedo), to 32 steps a
  /// channel, instead of fibre.absorption.
  bool useStrandColors = false;
  Vec3f headColor = Vec3f(0.50f, 0.40f, 0.34f);  ///< albedo, 0 … 1
};

struct PathTraceOptions {
  int width = 512, height = 512;  ///< pixels, 1 … 8192; the film's aspect, with square pixels, as in Preview
  int samplesPerPixel = 64;       ///< 2 … 2^20; the most with a target
  /// > 0: stop at the first of 16, 32, 64 … samples a pixel with PathTracePicture::relativeError at or below
  /// it. Looking at the error to decide makes a picture that stops a little too dark on average (less than
  /// its own confidence interval).
  double targetError = 0;
  int maxBounces = 1024;  ///< 1 … 65536
  int rouletteStart = 4;  ///< bounces before Russian roulette, 0 …
  std::uint64_t seed = 0;
  bool showSurroundings = false;  ///< behind the scene; else alpha is the share of rays that met something
};

struct PathTracePicture {
  FloatImage image;          ///< mean radiance, alpha
  FloatImage standardError;  ///< of each value of `image`: sample standard deviation / √samples
  int samplesPerPixel = 0;
  Vec3 mean = Vec3::Zero();          ///< of the picture's RGB
  Vec3 confidence95 = Vec3::Zero();  ///< the mean lies within ± this with a probability of 95 % (1.96
                                     ///< standard errors: the sum of many independent pixels is normal)
  double relativeError = 0;  ///< root mean square over pixels of luminance's standard error / mean luminance
  std::uint64_t paths = 0, rays = 0, shadowRays = 0;
  std::uint64_t truncatedPaths = 0;  ///< ended by maxBounces: light that is missing
  std::uint64_t invalidPaths = 0;    ///< gave no finite radiance and were counted as black
  std::size_t strandsDropped = 0;    ///< not drawable(), or without length
  double seconds = 0;
  std::vector<std::string> notes;  ///< a sentence each
};

/// Same scene, options and machine: same bytes for any number of threads. Radiance is linear RGB in the
/// lights' unit. Errors: InvalidArgument (sizes, options, camera, lights that are not finite or negative,
/// strands or ground that are malformed), Degenerate or Malformed (a head that fails validate), TooLarge,
/// Cancelled, Unsupported (built without Embree). Cost: some 0.8 million rays a second and thread, most of it
/// in the fibre function.
Result<PathTracePicture> pathTrace(const PathTraceScene& scene, const PathTraceOptions& options = {},
                                   const Context& context = {});

}  // namespace coif
