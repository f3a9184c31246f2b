// A curve from root to tip that is drawn with the mouse.
#pragma once

#include <imgui.h>

#include "coif/style/ramp.h"

namespace coif::studio {

/// A box of this size with the curve in it, root at the left, 1 at the top. Points are dragged; a click
/// beside them adds one, the right button or Ctrl + click takes one away, but not the last. True while it
/// changes.
bool editRamp(const char* id, Ramp& ramp, const ImVec2& size, float scale);

}  // namespace coif::studio
