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
  /// Keeps what of a vector the constraint allows, along these axes (columns).
  Vec3 apply(const Vec3& v, const Mat3& axes) const {
    Vec3 along = axes.transpose() * v;
    for (int i = 0; i < 3; ++i) {
      if (!allows(i)) along[i] = 0;
    }
    return axes * along;
  }
  bool allows(int i) const { return kind == Kind::Free || (kind == Kind::Axis ? i == axis : i != axis); }
};

class Gizmo {
 public:
  /// Of the hand tools Move, Rotate and Scale, about a point, along three axes (columns).
  Gizmo(HandTool hand, const Vec3& pivot, const Mat3& axes, const Viewport& view);

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
  Mat3 axes_;
  const Viewport& view_;
  float scale_;
  std::vector<Handle> handles_;
};

}  // namespace coif::studio
