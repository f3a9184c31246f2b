// What the artist has set for the mouse: the tool in hand, soft selection, snapping, brushes.
#pragma once

#include <string>

#include "coif/hairmesh/edit.h"
#include "coif/scene/command.h"

namespace coif::studio {

/// What the left button does in the view.
enum class HandTool { Select, Move, Rotate, Scale, Paint, Brush, Mask };
inline constexpr const char* kHandToolNames[] = {"Select",          "Move",  "Rotate",      "Scale",
                                                 "Paint selection", "Brush", "Paint a mask"};

struct SoftSettings {
  double radius = 0;  ///< scene units; 0: off
  std::string falloff = "smooth";
  bool surface = false;  ///< along the mesh, not through space

  void addTo(CommandArguments& arguments) const {
    if (radius <= 0) return;
    arguments["radius"] = radius;
    if (falloff != "smooth") arguments["falloff"] = falloff;
    if (surface) arguments["metric"] = std::string("surface");
  }
};

inline constexpr const char* kAxesNames[] = {"the scene's axes", "along the hair", "along the normal"};

enum class SnapTo { Grid, Vertex, Scalp };
struct SnapSettings {
  bool on = false;  ///< Ctrl turns it round while dragging
  SnapTo to = SnapTo::Grid;
  double step = 0;  ///< of the grid, scene units; set from the head's size when a document is opened
};

struct BrushSettings {
  std::string kind = "comb";
  double radiusPx = 60, strength = 0.5;
  std::string falloff = "smooth";
  bool through = false, onlySelected = false, keepOut = true;
};

struct ToolSettings {
  HandTool hand = HandTool::Select;
  SoftSettings soft;
  SnapSettings snap;
  AxesKind axes = AxesKind::World;  ///< of the gizmo, and of X, Y and Z while a tool runs
  BrushSettings brush;
  double maskValue = 1;  ///< what a mask is painted towards
  double paintRadiusPx = 24;
};

}  // namespace coif::studio
