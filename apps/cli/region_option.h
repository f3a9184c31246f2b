// --region: which part of the head carries hair, as one word on the command line.
#pragma once

#include <string>

#include "coif/scalp/region.h"

namespace coif::cli {

inline constexpr const char* kRegionHelp =
    "auto | all | group:NAME[,NAME…] | faces:0-99,120 | half-space:px,py,pz,nx,ny,nz | sphere:x,y,z,r | "
    "geodesic:x,y,z,r | shell:N";

/// Errors: InvalidArgument for a word that is none of these, and those of the region functions.
Result<Region> regionFromText(const std::string& text, const Surface& head, const CapOptions& cap);

/// Exactly `count` finite numbers with commas between them. Errors: InvalidArgument.
Result<std::vector<double>> numbers(const std::string& text, std::size_t count);

}  // namespace coif::cli
