// Tools of the mouse: select by click, box and lasso; move, rotate, scale and extrude with a preview.
#pragma once

#include <optional>
#include <string>

#include "keys.h"
#include "viewport.h"

namespace coif::studio {

/// A command that follows the mouse until it is confirmed: left button or Enter; Escape or the right button
/// drop it. X, Y, Z hold it to an axis; typed numbers replace the mouse.
class ModalTool {
 public:
  enum class Kind { Move, Rotate, Scale, Extrude };

  ModalTool(Kind kind, const Editor& editor, const Viewport& view, double softRadius);
  /// Follows this frame's mouse and keys; the arguments that the command would now have.
  void update(const Viewport& view, const Keys& keys);
  const char* command() const;
  CommandArguments arguments(const Viewport& view) const;
  bool confirmed() const { return confirmed_; }
  bool dropped() const { return dropped_; }
  std::string status() const;  ///< what is going on, for the status line

 private:
  Vec3 moveBy(const Viewport& view) const;
  double angleDeg(const Viewport& view) const;

  Kind kind_;
  Vec3 pivot_ = Vec3::Zero();
  Vec2 start_;
  Vec2 mouse_;
  double softRadius_ = 0, headScale_ = 1;
  int axis_ = -1;
  std::string typed_;
  bool confirmed_ = false, dropped_ = false;
};

/// Box (drag) and lasso (Ctrl + drag) selection; a click picks. Shift adds, Alt+Shift removes.
class SelectTool {
 public:
  /// The command to run now, if the mouse has just finished one.
  std::optional<CommandArguments> update(const Viewport& view);
  void draw(const Viewport& view) const;

 private:
  CommandArguments picked(const Viewport& view, const Selection& selection) const;

  std::vector<Vec2> path_;
  bool active_ = false, lasso_ = false;
};

/// `select`'s arguments for a selection.
CommandArguments selectArguments(const Selection& selection, const std::string& mode);

}  // namespace coif::studio
