// What Python sees as coif.StrandSet.
#pragma once

#include <optional>

#include "coif/strands/grow.h"
#include "coif/strands/strand_set.h"

namespace coif::python {

/// A strand set and, when grow() made it, what grow() said of it. The point count never changes, so views
/// stay valid.
struct Strands {
  StrandSet set;
  std::optional<GrowReport> report;
};

}  // namespace coif::python
