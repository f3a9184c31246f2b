// Brushes in the hand: a circle at the mouse, a stroke while the left button is down.
#pragma once

#include <optional>
#include <vector>

#include "keys.h"
#include "tool_settings.h"
#include "viewport.h"

namespace coif::studio {

/// A stroke that has just ended (run it), or goes on (show it).
struct BrushWork {
  CommandArguments arguments;
  bool ended = false;
};

class BrushTool {
 public:
  /// Follows mouse and keys. F and Shift + F change size and strength with the mouse until a click; '[' and
  /// ']' the size; Ctrl turns push, pull, inflate and twist round; Shift smooths.
  /// `over`: strokes lie on this surface, not on the hair; then every Ctrl turns round, and Shift does
  /// nothing.
  std::optional<BrushWork> update(const Viewport& view, const Keys& keys, BrushSettings& settings,
                                  const Surface* over = nullptr);
  void draw(const Viewport& view, const BrushSettings& settings) const;
  bool stroking() const { return !path_.empty(); }
  bool resizing() const { return resizing_ != Resizing::No; }
  /// Whether this frame's keys were the brush's own.
  bool tookKeys() const { return tookKeys_; }
  std::string status(const BrushSettings& settings) const;

 private:
  enum class Resizing { No, Size, Strength };
  void resize(const Viewport& view, const Keys& keys, BrushSettings& settings);
  void takeKeys(const Viewport& view, const Keys& keys, BrushSettings& settings);
  CommandArguments stroke(const Viewport& view, const BrushSettings& settings) const;
  Vec3 placeOf(const Viewport& view) const;
  const Surface* over_ = nullptr;

  std::vector<Vec3> path_;
  Vec2 lastPx_ = Vec2::Zero(), resizeFrom_ = Vec2::Zero();
  double radius_ = 0;  // scene units, of the stroke that goes on
  double before_ = 0;
  bool inverted_ = false, smooths_ = false, tookKeys_ = false;
  Resizing resizing_ = Resizing::No;
};

}  // namespace coif::studio
