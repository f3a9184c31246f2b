// Handles about the selection that are dragged to move, turn or scale it: axes, planes, rings and a middle.
#pragma once

#include <optional>
#include <vector>

#include "tool_settings.h"
#include "viewport.h"

namespace coif::studio {

/// What a move is held to.
struct Constraint {
  enum class Kind { Free, Axis, Plane } kind = Kind::Free;
  int axis = 0;  ///< of a plane: its normal
  bool operator==(const Constraint&) const = default;
  /// Keeps what of a vector the constraint allows.
  Vec3 apply(Vec3 v) const {
    for (int i = 0; i < 3; ++i) {
      if (!allows(i)) v[i] = 0;
    }
    return v;
  }
  bool allows(int i) const { return kind == Kind::Free || (kind == Kind::Axis ? i == axis : i != axis); }
};

class Gizmo {
 public:
  /// Of the hand tools Move, Rotate and Scale, about a point.
  Gizmo(HandTool hand, const Vec3& pivot, const Viewport& view, float scale);

  std::optional<Constraint> at(const Vec2& px) const;
  void draw(const std::optional<Constraint>& hot) const;

 private:
  struct Handle {
    Constraint constraint;
    std::vector<ImVec2> line;  ///< window pixels; closed and filled for planes and middles
    bool filled = false, arrow = false, box = false;
    ImU32 color = 0;
  };
  void addArms(bool boxes);
  void addRings();

  HandTool hand_;
  Vec3 pivot_;
  const Viewport& view_;
  float scale_;
  std::vector<Handle> handles_;
};

}  // namespace coif::studio
