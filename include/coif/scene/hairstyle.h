// Ready hairstyles: each modelled by the library's own operations on a cage of the head.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "coif/base/context.h"
#include "coif/base/result.h"
#include "coif/hairmesh/hair_mesh.h"
#include "coif/scalp/cage.h"
#include "coif/scalp/surface.h"

namespace coif {

/// "bob", "long", "bun", "mohawk", "pixie".
std::span<const std::string_view> hairstyleNames();

/// Quads that suit the style, so that the whole hair mesh stays below 1 500 vertices.
std::uint32_t suggestedCageCount(std::string_view style);

struct HairstyleReport {
  std::size_t pinned = 0;  ///< internal vertices that had to be pinned to keep the shape or stay off the head
  double worstDeviation =
      0;  ///< greatest distance of an unpinned internal vertex from its guide / head height
};

struct Hairstyle {
  HairMesh mesh;
  HairstyleReport report;
  double showFromDeg = 30;  ///< azimuth from which it shows best; 0 looks at the face
};

/// Models `style` on the cage: extrudes layers, separates the parting, lays the outer vertices along combed
/// guide curves, places the inner ones. The face stays free and every vertex outside the head. Errors:
/// InvalidArgument for an unknown style; Degenerate when the cage cannot carry it.
Result<Hairstyle> modelHairstyle(std::string_view style, const Cage& cage, const Surface& head,
                                 const Context& context = {});

}  // namespace coif
