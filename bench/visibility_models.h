// Hair for measuring shadows, and the places in it that a camera sees.
#pragma once

#include <string>
#include <vector>

#include "bench/bench.h"
#include "coif/light/camera.h"
#include "coif/light/light_view.h"
#include "coif/strands/strand_set.h"

namespace coif {

struct HairModel {
  std::string name;
  StrandSet strands;
  PolygonMesh head;  ///< opaque; empty for strands that come without one
  Box box;           ///< of the strands
};

/// The bob with 100 000 strands on the example head, made here; ponytail and mohawk from the folder that
/// COIF_SHARED_DATA names (else the one beside the sources), or the styles "long" and "mohawk" on the example
/// head where the files are absent. Quick: the bob alone, 8 000 strands.
std::vector<HairModel> hairModels(const BenchOptions& options);

/// A hair's place that a camera sees, and how much of its pixel.
struct SeenPoint {
  Vec3 world = Vec3::Zero();
  double weight = 0;
  std::size_t pixel = 0;  ///< y · pixels + x
};
/// One place a pixel: of the pixel's fragments, sorted by depth and cut by the head, one is drawn with the
/// probability of being what the eye sees there, α Π (1 − α of those before it); its weight is the pixel's
/// coverage by hair, 1 − Π (1 − α).
std::vector<SeenPoint> seenPoints(const HairModel& model, const Camera& camera, int pixels,
                                  const BenchOptions& options);

}  // namespace coif
