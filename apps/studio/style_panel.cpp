// The style: a stack of operators, filled by whatever kinds the library has; their numbers, ramps and masks.
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <utility>

#include "coif/style/style_kinds.h"
#include "ramp_widget.h"
#include "studio.h"

namespace coif::studio {
namespace {

/// A slider over what is usual; Ctrl + click takes a typed number up to what is accepted.
bool drawParameter(const StyleParameter& parameter, double& value) {
  const char* label = parameter.label.c_str();
  const double left = std::max(parameter.least, -parameter.usual);  // what is accepted may be far from usual
  bool changed = false;
  if (parameter.kind == ParameterKind::Flag) {
    bool on = value != 0;
    changed = ImGui::Checkbox(label, &on);
    value = on ? 1 : 0;
  } else if (parameter.kind == ParameterKind::Choice) {
    if (ImGui::BeginCombo(label, parameter.choices[std::size_t(value)].c_str())) {
      for (std::size_t i = 0; i < parameter.choices.size(); ++i) {
        if (ImGui::Selectable(parameter.choices[i].c_str(), double(i) == value))
          value = double(i), changed = true;
      }
      ImGui::EndCombo();
    }
  } else if (parameter.kind == ParameterKind::Integer) {
    int shown = int(value);
    changed = ImGui::SliderInt(label, &shown, int(left), int(parameter.usual));
    if (changed) value = std::clamp(double(shown), parameter.least, parameter.most);
  } else {
    float shown = float(value);
    const std::string format = "%.3g" + (parameter.unit.empty() ? std::string() : " " + parameter.unit);
    changed = ImGui::SliderFloat(label, &shown, float(left), float(parameter.usual), format.c_str());
    if (changed) value = std::clamp(double(shown), parameter.least, parameter.most);
  }
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", parameter.help.c_str());
  return changed;
}

CommandArguments rampArguments(const StyleOperator& op) {
  std::vector<double> numbers;
  for (const RampPoint& p : op.ramp.points) numbers.insert(numbers.end(), {p.x, p.y});
  return {{"operator", op.name},
          {"points", std::move(numbers)},
          {"shape", std::string(op.ramp.shape == RampShape::Linear ? "linear" : "smooth")}};
}

CommandArguments valueArguments(const StyleOperator& op, const std::string& parameter, double value) {
  return {{"operator", op.name}, {"parameter", parameter}, {"value", value}};
}

}  // namespace

const StyleStack& Studio::shownStyles() const {
  return pendingStyles_ ? *pendingStyles_ : document_->editor.state().styles;
}

std::string Studio::chosenOperator() const {
  if (!document_) return {};
  const StyleStack& stack = document_->editor.state().styles;
  if (indexOf(stack, chosenOperator_) != coif::kNone) return chosenOperator_;
  return stack.empty() ? std::string() : stack.back().name;
}

std::vector<Action> Studio::styleActions() {
  std::vector<Action> list;
  const auto noDocument = [this] { return document_ ? std::string() : std::string("no document is open"); };
  const auto noOperator = [this] {
    return chosenOperator().empty() ? "add an operator first" : std::string();
  };
  for (const StyleKind& kind : styleKinds()) {
    list.push_back({"add_" + kind.name,
                    "Add " + kind.label,
                    "Style/Add",
                    "",
                    kind.help,
                    [this, name = kind.name] { addOperator(name); },
                    {},
                    noDocument});
  }
  const auto add = [&](const char* name, const char* label, const char* key, const char* help,
                       std::function<void()> act) {
    list.push_back({name, label, "Style", key, help, std::move(act), {}, noOperator});
  };
  add("operator_above", "Choose the one above", "Ctrl+Up", "The panel shows the operator above.",
      [this] { chooseOperator(-1); });
  add("operator_below", "Choose the one below", "Ctrl+Down", "The panel shows the operator below.",
      [this] { chooseOperator(1); });
  add("operator_earlier", "Move up", "Ctrl+Shift+Up", "The chosen operator acts earlier.",
      [this] { moveOperator(-1); });
  add("operator_later", "Move down", "Ctrl+Shift+Down", "The chosen operator acts later.",
      [this] { moveOperator(1); });
  add("operator_on", "Switch on or off", "Ctrl+Shift+T", "Switches the chosen operator.", [this] {
    const StyleStack& stack = document_->editor.state().styles;
    const StyleOperator& op = stack[indexOf(stack, chosenOperator())];
    run("set_operator", valueArguments(op, "enabled", op.enabled ? 0 : 1));
  });
  add("name_operator", "Rename ...", "F2", "Gives the chosen operator another name.",
      [this] { nameAsked_ = true; });
  list.push_back({"hand_mask", "Paint a mask", "Style", "Ctrl+Shift+K",
                  "A brush changes where on the head the operator acts.",
                  [this] { takeUp(tools_.hand == HandTool::Mask ? HandTool::Select : HandTool::Mask, ""); },
                  [this] { return tools_.hand == HandTool::Mask; }, noOperator});
  return list;
}

void Studio::chooseOperator(int by) {
  const StyleStack& stack = document_->editor.state().styles;
  const auto to = std::ptrdiff_t(indexOf(stack, chosenOperator())) + by;
  chosenOperator_ = stack[std::size_t(std::clamp<std::ptrdiff_t>(to, 0, std::ssize(stack) - 1))].name;
}

void Studio::moveOperator(int by) {
  const StyleStack& stack = document_->editor.state().styles;
  const auto to = std::ptrdiff_t(indexOf(stack, chosenOperator())) + by;
  if (to < 0 || to >= std::ssize(stack)) return say("it is at the end of the list already", true);
  chosenOperator_ = chosenOperator();  // also where none was chosen and the last one is meant
  run("move_operator", {{"operator", chosenOperator_}, {"to", double(to)}});
}

void Studio::addOperator(const std::string& kind) {
  run("add_operator", {{"kind", kind}}, [this](const std::string& problem) {
    if (problem.empty()) chosenOperator_ = document_->editor.state().styles.back().name;
  });
}

void Studio::drawOperatorList() {
  const StyleStack stack = document_->editor.state().styles;  // a button changes it
  const float row = ImGui::GetFrameHeight();
  const std::string chosen = chosenOperator();
  for (std::size_t i = 0; i < stack.size(); ++i) {
    const StyleOperator& op = stack[i];
    ImGui::PushID(int(i));
    bool enabled = op.enabled;
    if (ImGui::Checkbox("##on", &enabled))
      run("set_operator", valueArguments(op, "enabled", enabled ? 1 : 0));
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("On or off.");
    ImGui::SameLine();
    if (ImGui::Selectable(
            op.name.c_str(), op.name == chosen, 0,
            {ImGui::GetContentRegionAvail().x - 3 * (row + ImGui::GetStyle().ItemSpacing.x), row}))
      chosenOperator_ = op.name;
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", findStyleKind(op.kind)->help.c_str());
    const auto button = [&](const char* label, const char* help, bool can) {
      ImGui::SameLine();
      ImGui::BeginDisabled(!can);
      const bool pressed = ImGui::Button(label, {row, row});
      ImGui::EndDisabled();
      if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", help);
      return pressed;
    };
    const auto to = [&](std::size_t place) {
      run("move_operator", {{"operator", op.name}, {"to", double(place)}});
    };
    if (button("\u2191", "Acts earlier.", i > 0)) to(i - 1);
    if (button("\u2193", "Acts later.", i + 1 < stack.size())) to(i + 1);
    if (button("x", "Takes it away.", true)) run("remove_operator", {{"operator", op.name}});
    ImGui::PopID();
  }
}

/// A step that a widget asks for; what it shows meanwhile is already in the operator.
struct Studio::StyleEdit {
  std::string command;
  CommandArguments arguments;
};

std::optional<Studio::StyleEdit> Studio::drawOperator(StyleOperator& op) {
  const StyleKind& kind = *findStyleKind(op.kind);
  const float scale = window_.scale();
  std::optional<StyleEdit> edit;
  const auto set = [&](const std::string& parameter, double value) {
    edit = {"set_operator", valueArguments(op, parameter, value)};
  };
  float amount = float(op.amount);
  if (ImGui::SliderFloat("amount", &amount, 0, 1, "%.2f"))
    op.amount = std::clamp(double(amount), 0.0, 1.0), set("amount", op.amount);
  for (const StyleParameter& parameter : kind.parameters) {
    double value = parameterOf(op, parameter.name);
    if (drawParameter(parameter, value)) op.parameters[parameter.name] = value, set(parameter.name, value);
  }
  if (kind.usesSeed) {
    int seed = int(std::min<std::uint64_t>(op.seed, 1u << 30));
    if (ImGui::InputInt("seed", &seed, 1, 100) && seed >= 0) op.seed = std::uint64_t(seed), set("seed", seed);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("Another number: another throw of the dice.");
  }
  if (kind.usesRamp) {
    ImGui::AlignTextToFramePadding();
    ImGui::TextDisabled("from root to tip");
    ImGui::SameLine();
    bool linear = op.ramp.shape == RampShape::Linear;
    if (ImGui::Checkbox("straight", &linear)) {
      op.ramp.shape = linear ? RampShape::Linear : RampShape::Smooth;
      edit = {"set_ramp", rampArguments(op)};
    }
    if (editRamp("ramp", op.ramp, {ImGui::GetContentRegionAvail().x, 96 * scale}, scale))
      edit = {"set_ramp", rampArguments(op)};
  }
  if (ImGui::BeginCombo("hair", op.group.empty() ? "all" : op.group.c_str())) {
    const auto offer = [&](const std::string& group, const char* label) {
      if (!ImGui::Selectable(label, group == op.group)) return;
      op.group = group;
      edit = {"set_operator", {{"operator", op.name}, {"parameter", std::string("group")}, {"text", group}}};
    };
    offer("", "all");
    for (const std::string& group : document_->editor.mesh().groupNames()) {
      if (!group.empty()) offer(group, group.c_str());
    }
    ImGui::EndCombo();
  }
  return edit;
}

void Studio::drawMaskButtons(const StyleOperator& op) {
  ImGui::TextDisabled(op.mask.empty() ? "mask: everywhere" : "mask: painted");
  const float third = (ImGui::GetContentRegionAvail().x - 2 * ImGui::GetStyle().ItemSpacing.x) / 3;
  const bool paints = tools_.hand == HandTool::Mask;
  if (paints) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
  const bool pressed = ImGui::Button("Paint", {third, 0});
  if (paints) ImGui::PopStyleColor();
  if (pressed) takeUp(paints ? HandTool::Select : HandTool::Mask, "");
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("Drag over the scalp; Ctrl takes away.");
  ImGui::SameLine();
  if (ImGui::Button("Everywhere", {third, 0})) run("set_mask", {{"operator", op.name}});
  ImGui::SameLine();
  if (ImGui::Button("Nowhere", {third, 0})) {
    std::vector<double> roots;
    for (const HairVertex& vertex : document_->editor.mesh().vertices()) {
      if (vertex.layer == 0) roots.push_back(double(std::uint32_t(vertex.id)));
    }
    run("set_mask", {{"operator", op.name}, {"vertices", roots}, {"values", std::vector<double>{0}}});
  }
}

void Studio::drawStylePanel() {
  if (!header("Style", nameAsked_)) return;
  ImGui::SetNextItemWidth(-1);
  if (ImGui::BeginCombo("##add", "Add an operator ...", ImGuiComboFlags_HeightLargest)) {
    for (const StyleKind& kind : styleKinds()) {
      if (ImGui::Selectable(kind.label.c_str())) addOperator(kind.name);
      if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", kind.help.c_str());
    }
    if (window_.keys().pressed("Escape")) ImGui::CloseCurrentPopup();
    ImGui::EndCombo();
  }
  drawOperatorList();
  StyleStack shown = shownStyles();
  const std::uint32_t at = indexOf(shown, chosenOperator());
  if (at == coif::kNone) return;
  ImGui::Separator();
  ImGui::PushItemWidth(0.55f * ImGui::GetContentRegionAvail().x);
  ImGui::PushID(shown[at].name.c_str());
  std::string name = shown[at].name;
  if (std::exchange(nameAsked_, false)) ImGui::SetKeyboardFocusHere();
  if (ImGui::InputText("name", &name, ImGuiInputTextFlags_EnterReturnsTrue) && name != shown[at].name) {
    run("rename_operator", {{"operator", shown[at].name}, {"name", name}},
        [this, name](const std::string& problem) {
          if (problem.empty()) chosenOperator_ = name;
        });
  }
  const auto edit = drawOperator(shown[at]);
  drawMaskButtons(shown[at]);
  if (edit) {
    pendingStyles_ = std::move(shown), ++pendingStylesNumber_;
    settle(edit->command, edit->arguments, true);
  } else if (pendingStyles_) {
    settle(pendingCommand_, pendingArguments_, false);
  }
  ImGui::PopID();
  ImGui::PopItemWidth();
}

// Masks.

CommandArguments Studio::maskArguments(const BrushWork& work) const {
  CommandArguments out{{"operator", chosenOperator()}};
  for (const char* same : {"path", "radius", "falloff", "through"}) {
    if (work.arguments.contains(same)) out[same] = work.arguments.at(same);
  }
  const double strength = std::get<double>(work.arguments.at("strength"));
  out["strength"] = std::abs(strength);
  out["value"] = strength < 0 ? 1 - tools_.maskValue : tools_.maskValue;
  return out;
}

void Studio::followMask() {
  const Trace::Span span(trace_, "drag");
  const auto work = brush_.update(view_, window_.keys(), tools_.brush, document_->head().get());
  paintedMask_.reset();
  if (!work) return;
  const CommandArguments arguments = maskArguments(*work);
  if (work->ended) return run("paint_mask", arguments);
  const auto painted = document_->editor.prepare("paint_mask", arguments);
  if (!painted.ok()) return say(painted.error().text(), true);
  const std::uint32_t at = indexOf(painted->state.styles, chosenOperator());
  if (at != coif::kNone) paintedMask_ = painted->state.styles[at].mask;
}

std::vector<double> Studio::shownMask() const {
  const StyleStack& stack = document_->editor.state().styles;
  const std::uint32_t at = indexOf(stack, chosenOperator());
  if (at == coif::kNone) return {};
  return maskOf(paintedMask_ ? *paintedMask_ : stack[at].mask, document_->editor.mesh());
}

}  // namespace coif::studio
