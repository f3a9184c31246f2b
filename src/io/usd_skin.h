// UsdSkel's binding primvars on the prims that are written.
#pragma once

#include "coif/strands/skin.h"
#include "usd_layer.h"

namespace coif::io::usd {

/// Applies SkelBindingAPI. `rows` names, for each point of the prim, the element of `skin` that moves it; a
/// rigid binding is written once, as constant.
void bindToSkeleton(const SkinBinding& skin, std::span<const std::uint32_t> rows, Prim& prim);

/// The same, point v by element v.
void bindVertices(const SkinBinding& skin, std::size_t vertices, Prim& prim);

/// "/Rig/Skeleton": an absolute path of prims by plain names.
bool isPrimPath(std::string_view path);

/// Refuses bindings of another size than what they move, or without a skeleton's path.
Status checkSkin(const StrandExport& what);

}  // namespace coif::io::usd
