// The arrays that a glTF by Coif keeps per strand, in one buffer view, one after the other without gaps:
//   pointCounts u32, ids u64, groups u32, rootFaces u32, weightCounts u32, weights f32, guides u8.
// asset.extras.coif lists those present, in this order, with their lengths.
#pragma once

#include <nlohmann/json.hpp>

#include "io/gltf_builder.h"

namespace coif::io {

std::uint64_t strandTableBytes(const StrandSet& strands);
void writeStrandTable(const StrandSet& strands, const GltfBuilder::Sink& sink);
nlohmann::ordered_json describeStrandTable(const StrandSet& strands);

}  // namespace coif::io
