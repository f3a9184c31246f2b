// Move, rotate and scale with the mouse: freely, along an axis, in a plane, by typed numbers, with snapping.
#pragma once

#include "gizmo.h"
#include "modal_tool.h"

namespace coif::studio {

class TransformTool : public ModalTool {
 public:
  /// `hand`: Move, Rotate or Scale. `held`: the gizmo's handle that was pressed; then the release confirms.
  TransformTool(HandTool hand, const Editor& editor, const Viewport& view, const ToolSettings& settings,
                const Surface* head, std::optional<Constraint> held = std::nullopt);

  void update(const Viewport& view, const Keys& keys) override;
  std::string command() const override;
  CommandArguments arguments() const override;
  std::string status() const override;
  std::string label() const override;
  void draw(const Viewport& view) const override;
  bool usesWheel() const override { return soft_.radius > 0; }
  double softRadius() const { return soft_.radius; }
  const Vec3& pivot() const { return pivot_; }

 private:
  Vec3 moveBy(const Viewport& view);
  Vec3 snapped(const Viewport& view, const Vec3& by);
  double turnDeg(const Viewport& view) const;
  Vec3 factors(const Viewport& view) const;
  Vec3 axisOf(const Viewport& view) const;
  void takeConstraint(const Keys& keys);

  HandTool hand_;
  Constraint constraint_;
  bool held_;
  std::vector<VertexId> own_;  // ascending: no one snaps to itself
  Vec3 pivot_ = Vec3::Zero();
  Mat3 axes_;  // columns
  Vec2 start_, mouse_;
  SoftSettings soft_;
  SnapSettings snap_;
  bool snapping_ = false;
  const Surface* head_;
  TypedNumbers typed_;
  Vec3 by_ = Vec3::Zero(), axis_ = Vec3::UnitY(), factors_ = Vec3::Ones();
  double angleDeg_ = 0;
  std::optional<Vec3> snapMark_;
};

}  // namespace coif::studio
