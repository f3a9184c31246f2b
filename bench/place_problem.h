// Hair meshes for measuring placement.
#pragma once

#include <string>

#include "coif/hairmesh/hair_mesh.h"

namespace coif {

enum class PlaceKind { Uniform, Mixed, MixedAndSplit };

struct PlaceProblem {
  std::uint32_t side = 0, height = 0;  ///< side × side root quads on the unit square; layers above the root
  PlaceKind kind = PlaceKind::Uniform;
  std::string name() const;
  std::string title() const;
};

/// Heights: all alike, or drawn from {⌈n/2⌉, …, n} on 5 × 5 patches. Splits: above layer n/2 the mesh grows
/// in four strips that share nothing, as if three lines of edges had been separated. Every vertex above the
/// root is shaken, so that neither the outside nor the starting point is smooth.
HairMesh placeProblemMesh(const PlaceProblem& problem, std::uint64_t seed);

}  // namespace coif
