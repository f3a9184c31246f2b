// Finding prims of a layer with the place they stand at: transforms, visibility and purpose come from above.
#pragma once

#include <Eigen/Core>

#include "coif/scalp/polygon_mesh.h"
#include "coif/strands/strand_set.h"
#include "usd_layer.h"

namespace coif::io::usd {

/// A prim with what it inherits.
struct Placed {
  const Prim* prim = nullptr;
  std::string path;  ///< for messages: shortened in front when very long
  Eigen::Matrix4d worldFromPrim = Eigen::Matrix4d::Identity();
  bool helper = false;  ///< purpose guide or proxy: not what is rendered
};

/// Every defined, active prim of that type, depth first; prototypes of instancers and classes are left out
/// (noted). Errors: Unsupported (a transform of an unknown kind), Malformed (a transform without a value).
Result<std::vector<Placed>> placedPrims(const Layer& layer, std::string_view typeName, MemoryBudget& budget,
                                        std::vector<std::string>& notes);

/// The Mesh prims that a mesh file is read from, guides and proxies only where there is nothing else. Errors:
/// Unsupported when there is none.
Result<std::vector<Placed>> meshesOf(const Layer& layer, MemoryBudget& budget,
                                     std::vector<std::string>& notes);
/// How many vertices a Mesh prim gives the mesh that is read: none without points, counts and corners.
std::size_t vertexCountOf(const Prim& mesh);

/// The prim's own transform by its xformOpOrder; `resets` when it starts from the world again.
Result<Eigen::Matrix4d> localTransform(const Prim& prim, bool& resets);

double metersPerUnit(const Layer& layer, double otherwise);
UpAxis upAxis(const Layer& layer);

/// A primvar's numbers, `components` of each element, indices (`name:indices`) applied. Empty when there is
/// none.
std::vector<float> primvarNumbers(const Prim& prim, const std::string& name, int components);
/// The stated interpolation of an attribute; empty when it says none.
std::string_view interpolationOf(const Prim& prim, std::string_view name);

/// The strands of a BasisCurves prim, in the world; what was converted or left out goes to `notes`. Groups
/// are numbers without names yet. Errors: Malformed (counts that do not add up to the points), TooLarge.
Result<StrandSet> readCurves(const Placed& placed, MemoryBudget& budget, std::vector<std::string>& notes);

}  // namespace coif::io::usd
