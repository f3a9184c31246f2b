// An operation on the mesh that is seen before it is done: its number follows the mouse, its choice the
// wheel.
#pragma once

#include <vector>

#include "modal_tool.h"

namespace coif::studio {

class OperationTool : public ModalTool {
 public:
  /// Any command that changes the mesh's topology.
  OperationTool(const std::string& command, const Editor& editor, const Viewport& view);

  void update(const Viewport& view, const Keys& keys) override;
  std::string command() const override { return info_->name; }
  CommandArguments arguments() const override;
  std::string status() const override;
  std::string label() const override;
  void draw(const Viewport& view) const override;
  bool usesWheel() const override { return extrudes() || !choice_.empty(); }

 private:
  bool extrudes() const { return info_->name == "extrude"; }
  void updateExtrude(const Viewport& view, const Keys& keys);
  void takeCurve(const Viewport& view);

  const CommandInfo* info_;
  Vec3 pivot_ = Vec3::Zero();
  Vec2 start_;
  TypedNumbers typed_;
  CommandArguments values_;      // those that are not as standard
  std::string number_, choice_;  // names of the arguments that mouse and wheel change; may be empty
  std::size_t chosen_ = 0;
  double layers_ = 1, bend_ = 0;  // of an extrusion
  bool freely_ = false, drawing_ = false, drawn_ = false;
  std::vector<Vec3> curve_;
};

}  // namespace coif::studio
