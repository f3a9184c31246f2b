// Hair to scatter light: a cube of nearly parallel fibres, and styles on a head.
#pragma once

#include <string>
#include <vector>

#include "bench/bench.h"
#include "coif/light/camera.h"
#include "coif/light/hair_color.h"
#include "coif/light/lights.h"
#include "coif/scalp/polygon_mesh.h"
#include "coif/strands/strand_set.h"

namespace coif {

struct ScatteringScene {
  std::string name;
  StrandSet strands;
  PolygonMesh head;  ///< may be empty
  Camera camera;
  Lights lights;  ///< distant ones alone
  int size = 48;  ///< pixels a side
};

/// A cube of side 1 with `side`² fibres along x, one in the middle of a cell but for a shake, a quarter of
/// the cell in radius, tilted by up to two degrees; seen from +z, slightly from above. The light stands at
/// these angles from the view, around the fibres and along them.
ScatteringScene clusterScene(int side, double aroundDeg, double alongDeg, std::uint64_t seed);
/// A ready style on the example head, key and rim lights. Fewer than 100 000 hairs are wider, so that as much
/// light is blocked.
ScatteringScene styledScene(const std::string& name, std::size_t hairs, const BenchOptions& options,
                            std::uint32_t strandPoints = 24);

/// A single distant light in the scene's frame.
Lights oneLight(const Vec3& toLight, double irradiance);

}  // namespace coif
