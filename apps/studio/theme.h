// Colours, spacing and type of the studio.
#pragma once

namespace coif::studio {

/// Sets Dear ImGui's style and fonts for a display of this scale (1: 96 dots an inch). Fonts are the system's
/// (or COIF_FONT); without any, Dear ImGui's own. Call before the first frame, or between two.
void applyTheme(bool light, float scale);

}  // namespace coif::studio
