// One entry of a style's stack, as data: which kind, how strong, where on the head and where along the hair.
//
// Kinds and their parameters are in style_kinds.h; what a stack does to strands in style_plan.h.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "coif/base/result.h"
#include "coif/hairmesh/hair_mesh.h"
#include "coif/style/ramp.h"

namespace coif {

/// A scalar in [0, 1] on root vertices; a strand takes the mean of its root face's corners by its weights.
/// Ascending by id. Empty: 1 everywhere. A root vertex that is not listed (it came later) takes the mean of
/// its neighbours.
using StyleMask = std::vector<std::pair<VertexId, double>>;

struct StyleOperator {
  std::string kind;  ///< of styleKinds(): "curl"
  std::string name;  ///< of its own in the stack: "Curl", "Curl 2"
  bool enabled = true;
  double amount = 1;                         ///< 0 … 1; 0 changes nothing
  std::map<std::string, double> parameters;  ///< those that differ from the kind's own; choices by index
  Ramp ramp;                                 ///< strength from root to tip; not every kind asks it
  StyleMask mask;
  std::string group;  ///< only hair of this group of bundles; empty: all
  std::uint64_t seed = 1;
  bool operator==(const StyleOperator&) const = default;
};

/// In the order in which they act.
using StyleStack = std::vector<StyleOperator>;

/// Refuses an unknown kind or parameter, values out of range or not finite, a bad ramp or mask, an empty
/// name or one that two operators share. The error's place is "[2].ramp": which operator, which part.
Status validate(std::span<const StyleOperator> stack);

/// Position in the stack; kNone when there is none of that name.
std::uint32_t indexOf(std::span<const StyleOperator> stack, std::string_view name);
/// `wanted`, or `wanted` with the first number that makes it unlike all names of the stack.
std::string freeName(std::span<const StyleOperator> stack, const std::string& wanted);

/// The mask at every vertex of the mesh's root layer, by vertex index (vertices above: 0).
std::vector<double> maskOf(const StyleMask& mask, const HairMesh& mesh);

}  // namespace coif
