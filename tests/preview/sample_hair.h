// Heads of hair to draw.
#pragma once

#include <memory>
#include <string_view>

#include "coif/scene/hairstyle.h"
#include "coif/strands/grow.h"
#include "strands/sample_meshes.h"

namespace coif::samples {

/// A ready hairstyle on a head.
struct HeadHair {
  std::unique_ptr<Surface> surface;
  HairMesh mesh;
};
inline HeadHair headHair(std::string_view style, const PolygonMesh& head) {
  HeadHair out{std::make_unique<Surface>(head), {}};
  CageOptions options;
  options.count = int(suggestedCageCount(style));
  const Region region = automaticCap(*out.surface).value();
  const Cage cage = buildCage(out.surface->mesh(), *out.surface, region, options).value();
  out.mesh = modelHairstyle(style, cage, *out.surface).value().mesh;
  return out;
}

/// Pentagons and triangles side by side, with an edge apart from layer 2 on and layers of different heights.
inline HairMesh splitPolygons() {
  const std::vector<Vec3> positions{{0, 0, 0},      {1, 0, 0},       {1.4, 0, -0.8},
                                    {0.5, 0, -1.4}, {-0.4, 0, -0.8}, {2, 0, 0.2}};
  const std::vector<std::uint32_t> offsets{0, 5, 8}, corners{0, 1, 2, 3, 4, 1, 5, 2};
  HairMesh mesh = HairMesh::fromRoot(positions, offsets, corners).value();
  raise(mesh, 3, 0.7, 0.2);
  const BundleId taller = mesh.bundles()[0].id;
  ExtrudeOptions options;
  options.direction = Vec3(0.3, 0.4, 0.1);
  extrudeFaces(mesh, std::span(&taller, 1), options).value();
  for (std::uint32_t side = 0; side < 5; ++side) {
    const auto face = mesh.bundles()[0].face(2);
    const auto root = mesh.bundles()[0].face(0);
    const bool shared =
        (root[side] == 1 && root[(side + 1) % 5] == 2) || (root[side] == 2 && root[(side + 1) % 5] == 1);
    if (shared && face.size() == 5) (void)separateEdge(mesh, {taller, 2, side});
  }
  return mesh;
}

inline StrandSet grownOn(const HairMesh& mesh, std::size_t count, Knots knots = Knots::Uniform,
                         const Surface* head = nullptr, double width = 0.004) {
  GrowOptions options;
  options.count = count;
  options.knots = knots;
  options.head = head;
  options.width = width;
  return grow(mesh, options).value().strands;
}

}  // namespace coif::samples
