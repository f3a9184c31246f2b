// Style stacks as plain Python data: a list of dicts.
#pragma once

#include "bind.h"
#include "coif/style/style_operator.h"

namespace coif::python {

nb::list fromStyles(const StyleStack& styles);
/// Raises TypeError for what is no list of dicts, Error for what is no style.
StyleStack toStyles(const nb::object& list);
void bindStyle(nb::module_& m);

}  // namespace coif::python
