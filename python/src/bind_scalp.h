// What Python sees as coif.Scalp.
#pragma once

#include <filesystem>
#include <memory>

#include "bind.h"
#include "coif/scalp/cage.h"
#include "coif/scalp/region.h"
#include "coif/scalp/surface.h"

namespace coif::python {

/// A head and the file it came from. The surface is shared with the hair meshes made on it.
struct ScalpModel {
  std::shared_ptr<const Surface> surface;
  std::filesystem::path path;
};

/// The cage on a region of the scalp, or on its automatic cap.
Cage makeCage(const ScalpModel& scalp, const std::optional<Region>& region, const CageOptions& options);

void bindRegions(nb::module_& m);
void bindCage(nb::module_& m);

}  // namespace coif::python
