// What stands around the hair mesh: backdrop, ground grid, the head as lines or glass, the axes in the
// corner.
#pragma once

#include "viewport.h"

namespace coif::studio {

/// Behind the picture: a gradient, and a grid on the ground below the model, one line a `step`.
void paintBackdrop(const Viewport& view, bool lightTheme);
void paintGrid(const Viewport& view, const Box& model, double step);
/// The head where the picture leaves it out: lines of the faces that look at the eye, or these faces as
/// glass. False: it has too many faces for that.
bool paintHead(const Viewport& view, const Surface& head, HeadStyle style);

/// The axes in the view's upper right corner. A click on one looks along it.
struct AxisView {
  const char* action;  ///< name of the studio's action
};
std::optional<AxisView> paintAxes(const Viewport& view, float scale);

}  // namespace coif::studio
