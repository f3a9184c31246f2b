// Selecting with the mouse: click, box, lasso, loops, and painting with a circle.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tool_settings.h"
#include "viewport.h"

namespace coif::studio {

/// A command that the mouse has just finished.
struct Wish {
  std::string command;
  CommandArguments arguments;
};

class SelectTool {
 public:
  /// Click picks; drag: a box; Ctrl + drag: a lasso. Shift adds (a click toggles), Shift + Alt removes. Alt +
  /// click (a double click) takes the edge loop, Ctrl + Alt + click the ring.
  std::vector<Wish> update(const Viewport& view, const HairMesh& mesh);
  /// A circle selects what it is dragged over; Ctrl: takes away. One command a stroke.
  std::vector<Wish> paint(const Viewport& view, const HairMesh& mesh, ToolSettings& settings);
  void draw(const Viewport& view, const ToolSettings& settings) const;
  /// What a stroke of the circle has gathered so far; null: no stroke.
  const Selection* painted() const { return painting_ ? &painted_ : nullptr; }

 private:
  std::vector<Wish> finish(const Viewport& view, const HairMesh& mesh);
  std::vector<Wish> along(const Viewport& view, const HairMesh& mesh, bool ring) const;

  std::vector<Vec2> path_;
  bool active_ = false, lasso_ = false, loop_ = false, ring_ = false;
  bool painting_ = false, erasing_ = false;
  Selection painted_;
};

/// `select`'s arguments for a selection.
CommandArguments selectArguments(const Selection& selection, const std::string& mode);
/// What lies under the mouse of the kind that is selected.
Selection under(const Viewport& view, const HairMesh& mesh);

}  // namespace coif::studio
