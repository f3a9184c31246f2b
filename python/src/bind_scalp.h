// What Python sees as coif.Scalp.
#pragma once

#include <filesystem>
#include <memory>

#include "bind.h"
#include "coif/scalp/region.h"
#include "coif/scalp/surface.h"

namespace coif::python {

/// A head and the file it came from. The surface is shared with the hair meshes made on it.
struct ScalpModel {
  std::shared_ptr<const Surface> surface;
  std::filesystem::path path;
};

void bindRegions(nb::module_& m);

}  // namespace coif::python
