#include "operation_tool.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace coif::studio {
namespace {

constexpr double kFullRangePx = 240;  // the mouse's way for a number from its least to its greatest
constexpr double kCurveStepPx = 4;

const CommandArgument* argumentOf(const CommandInfo& info, const std::string& name) {
  const auto found = std::ranges::find(info.arguments, name, &CommandArgument::name);
  return found == info.arguments.end() ? nullptr : &*found;
}

}  // namespace

OperationTool::OperationTool(const std::string& command, const Editor& editor, const Viewport& view)
    : info_(findCommand(command)), start_(view.mouse()) {
  const auto chosen = selectedVertices(editor.mesh(), editor.state().selection);
  for (std::uint32_t v : chosen) pivot_ += editor.mesh().position(v) / double(chosen.size());
  for (const CommandArgument& argument : info_->arguments) {
    if (argument.kind == ArgumentKind::Number && number_.empty()) number_ = argument.name;
    if (argument.kind == ArgumentKind::Choice && choice_.empty()) choice_ = argument.name;
  }
}

void OperationTool::takeCurve(const Viewport& view) {
  const double depth = (pivot_ - view.camera.eye).dot(view.forward());
  const auto at = [&](const Vec2& px) { return Vec3(view.camera.eye + depth * view.ray(px)); };
  if (ImGui::IsMouseClicked(0)) drawing_ = true, curve_ = {at(view.mouse())};
  if (!drawing_) return;
  if ((view.project(curve_.back()).px - view.mouse()).norm() > kCurveStepPx)
    curve_.push_back(at(view.mouse()));
  if (!ImGui::GetIO().MouseDown[0]) drawing_ = false, drawn_ = curve_.size() > 1;
}

void OperationTool::updateExtrude(const Viewport& view, const Keys& keys) {
  const ImGuiIO& io = ImGui::GetIO();
  if (io.MouseWheel != 0 && io.KeyShift) bend_ = std::clamp(bend_ + 0.05 * double(io.MouseWheel), 0.0, 1.0);
  if (io.MouseWheel != 0 && !io.KeyShift) layers_ = std::clamp(layers_ + double(io.MouseWheel), 1.0, 100.0);
  if (keys.pressed("G")) bend_ = bend_ > 0 ? 0 : 0.35, layers_ = bend_ > 0 ? std::max(layers_, 4.0) : layers_;
  if (keys.pressed("D")) freely_ = !freely_;
  if (keys.pressed("C") && curve_.empty()) curve_ = {pivot_}, layers_ = std::max(layers_, 4.0);
  values_.clear();
  if (layers_ > 1) values_["layers"] = std::round(layers_);
  if (!curve_.empty()) {
    std::vector<double> numbers;
    for (const Vec3& p : curve_) numbers.insert(numbers.end(), {p.x(), p.y(), p.z()});
    if (curve_.size() > 1) values_["curve"] = std::move(numbers);
    return;
  }
  const double unit = view.unitsPerPixel(pivot_);
  const Vec2 d = view.mouse() - start_;
  if (freely_ && !typed_.any()) {
    values_["direction"] = Vec3(unit * (d.x() * view.right() - d.y() * view.up()));
    return;
  }
  values_["distance"] = typed_.any() ? typed_.number(0) : -unit * d.y();
  if (bend_ > 0) values_["bend"] = bend_;
}

void OperationTool::update(const Viewport& view, const Keys& keys) {
  typed_.take(keys);
  const bool byCurve = !curve_.empty();
  if (byCurve) takeCurve(view);
  if (extrudes()) {
    updateExtrude(view, keys);
  } else {
    const float wheel = ImGui::GetIO().MouseWheel;
    if (!choice_.empty()) {
      const CommandArgument& argument = *argumentOf(*info_, choice_);
      if (wheel != 0) chosen_ = (chosen_ + 1) % argument.choices.size();
      if (chosen_ > 0)
        values_[choice_] = argument.choices[chosen_];
      else
        values_.erase(choice_);
    }
    if (!number_.empty()) {
      const CommandArgument& argument = *argumentOf(*info_, number_);
      const double range = argument.most - argument.least;
      const double moved =
          std::get<double>(argument.standard) + (view.mouse() - start_).x() / kFullRangePx * range;
      // Two digits: what a hand can mean.
      const double value = typed_.any() ? typed_.number(0) : std::round(100 * moved / range) / 100 * range;
      values_[number_] = std::clamp(value, argument.least, argument.most);
    }
  }
  if (byCurve) {
    takeEnd(keys, false);
    if (ImGui::IsMouseClicked(0) || drawing_) dropConfirmation();
    if (drawn_) confirm();
  } else {
    takeEnd(keys, false);
  }
}

CommandArguments OperationTool::arguments() const {
  return values_;
}

std::string OperationTool::label() const {
  char text[96] = "";
  if (extrudes() && values_.contains("distance")) {
    std::snprintf(text, sizeof text, "%.4g in %.0f layer%s", std::get<double>(values_.at("distance")),
                  layers_, layers_ > 1 ? "s" : "");
  } else if (values_.contains(number_)) {
    std::snprintf(text, sizeof text, "%.3g", std::get<double>(values_.at(number_)));
  } else if (!choice_.empty()) {
    return argumentOf(*info_, choice_)->choices[chosen_];
  }
  return text;
}

std::string OperationTool::status() const {
  std::string text = info_->label;
  if (typed_.any()) text += ": " + typed_.text();
  if (extrudes())
    return text +
           "   (wheel: layers, Shift + wheel or G: gravity, D: freely, C: draw a curve, digits: exact, Esc: "
           "drop)";
  if (!number_.empty()) text += "   (mouse or digits: " + number_;
  if (!choice_.empty()) text += std::string(number_.empty() ? "   (" : ", ") + "wheel: " + choice_;
  return text + (number_.empty() && choice_.empty() ? "   (" : ", ") + "click or Enter: done, Esc: drop)";
}

void OperationTool::draw(const Viewport& view) const {
  std::vector<ImVec2> line;
  for (const Vec3& p : curve_) line.push_back(view.toWindow(view.project(p).px));
  if (line.size() > 1)
    ImGui::GetBackgroundDrawList()->AddPolyline(line.data(), int(line.size()), IM_COL32(255, 225, 90, 255), 0,
                                                2.5f);
}

}  // namespace coif::studio
