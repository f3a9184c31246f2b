// What stands around the hair mesh: backdrop, ground grid, the head as lines or glass, the axes in the
// corner.
#pragma once

#include "viewport.h"

namespace coif::studio {

/// Behind the picture: a gradient, and a grid on the ground below the model, one line a `step`.
void paintBackdrop(const Viewport& view, bool lightTheme);
void paintGrid(const Viewport& view, const Box& model, double step);
/// The head where the picture leaves it out: lines of the faces that look at the eye, or these faces as
/// glass.
void paintHead(const Viewport& view, const Surface& head, HeadStyle style);
/// Whether it has few enough faces for that.
bool canPaintHead(const Surface& head);

/// The axes in the view's upper right corner; the one under the mouse is bright.
void paintAxes(const Viewport& view, float scale);
/// The action that looks along the axis under the mouse; null where there is none.
const char* axisAt(const Viewport& view, float scale);

}  // namespace coif::studio
