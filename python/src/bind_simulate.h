// What the simulate and scene bindings share.
#pragma once

#include "bind.h"
#include "coif/simulate/simulation.h"

namespace coif::python {

void bindSimulate(nb::module_& m);

/// From (F, 4, 4) poses and (F, R, 3) root positions, either may be None.
HeadMotion toMotion(const nb::object& poses, const nb::object& roots);

}  // namespace coif::python
