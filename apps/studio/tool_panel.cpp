// The tools: their menu and keys, and the panel at the left with what they can be set to.
#include <imgui.h>

#include <algorithm>

#include "studio.h"

namespace coif::studio {
namespace {

struct Brush {
  const char *kind, *label, *key, *help;
};
constexpr Brush kBrushes[] = {
    {"comb", "Comb", "Shift+5", "Takes hair along; its length stays."},
    {"grab", "Grab", "Shift+6", "Moves what lies under the mouse."},
    {"push", "Push", "Shift+7", "Presses hair in."},
    {"pull", "Pull", "Shift+8", "Draws hair out."},
    {"inflate", "Inflate", "Shift+9", "Makes hair fuller."},
    {"twist", "Twist", "Shift+0", "Rolls hair about its own direction: stroke across it."},
    {"smooth", "Smooth", "Shift+-", "Relaxes hair."},
};
constexpr const char* kFalloffs[] = {"smooth", "linear", "sharp", "round", "constant"};

bool toggle(const char* label, bool on, float width) {
  if (on) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
  const bool pressed = ImGui::Button(label, {width, 0});
  if (on) ImGui::PopStyleColor();
  return pressed;
}

void heading(const char* text) {
  ImGui::Separator();
  ImGui::TextDisabled("%s", text);
}

void falloffCombo(std::string& falloff) {
  ImGui::SetNextItemWidth(-1);
  if (!ImGui::BeginCombo("##falloff", ("falloff: " + falloff).c_str())) return;
  for (const char* name : kFalloffs) {
    if (ImGui::Selectable(name, falloff == name)) falloff = name;
  }
  ImGui::EndCombo();
}

void slider(const char* id, double& value, float least, float most, const char* format,
            bool logarithmic = false) {
  float shown = float(value);
  ImGui::SetNextItemWidth(-1);
  if (ImGui::SliderFloat(id, &shown, least, most, format, logarithmic ? ImGuiSliderFlags_Logarithmic : 0))
    value = double(shown);
}

}  // namespace

void Studio::takeUp(HandTool hand, const std::string& brush) {
  tools_.hand = hand;
  if (!brush.empty()) tools_.brush.kind = brush;
  paintedMask_.reset();
  say(hand == HandTool::Brush ? brush_.status(tools_.brush) : kHandToolNames[int(hand)]);
}

std::vector<Action> Studio::toolActions() {
  std::vector<Action> list;
  const auto hand = [&](const char* name, const char* key, const char* help, HandTool tool) {
    list.push_back({name, kHandToolNames[int(tool)], "Tools", key, help, [this, tool] { takeUp(tool, ""); },
                    [this, tool] { return tools_.hand == tool; }});
  };
  hand("hand_select", "W Shift+1 Escape", "Click, box and lasso.", HandTool::Select);
  hand("hand_move", "Shift+2", "Handles that move the selection.", HandTool::Move);
  hand("hand_rotate", "Shift+3", "Handles that turn the selection.", HandTool::Rotate);
  hand("hand_scale", "Shift+4", "Handles that scale the selection.", HandTool::Scale);
  hand("hand_paint", "C", "A circle selects what it is dragged over.", HandTool::Paint);
  for (const Brush& b : kBrushes) {
    const std::string kind = b.kind;
    list.push_back({"brush_" + kind, std::string(b.label) + " brush", "Tools/Brushes", b.key, b.help,
                    [this, kind] { takeUp(HandTool::Brush, kind); },
                    [this, kind] { return tools_.hand == HandTool::Brush && tools_.brush.kind == kind; }});
  }
  list.push_back({"soft_selection", "Soft selection", "Tools", "O", "Moves take their surroundings along.",
                  [this] {
                    double& radius = tools_.soft.radius;
                    radius = radius > 0 ? 0 : 5 * tools_.snap.step;
                  },
                  [this] { return tools_.soft.radius > 0; }});
  list.push_back({"axes_next", "Next axes", "Tools", ",",
                  "Handles, and X, Y and Z, go along the scene's axes, the hair, or its normal.", [this] {
                    tools_.axes = AxesKind((int(tools_.axes) + 1) % 3);
                    say(std::string("axes: ") + kAxesNames[int(tools_.axes)]);
                  }});
  list.push_back({"snapping", "Snapping", "Tools", "Shift+Tab",
                  "Moves end on the grid, a vertex or the scalp.",
                  [this] { tools_.snap.on = !tools_.snap.on; }, [this] { return tools_.snap.on; }});
  return list;
}

void Studio::drawHandTools() {
  const float half = 0.5f * (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x);
  int column = 0;
  const auto button = [&](const char* label, bool on, const std::string& action) {
    if (column++ % 2 == 1) ImGui::SameLine();
    for (const MenuEntry& entry : entries()) {
      if (entry.name != action) continue;
      if (toggle(label, on, half)) carryOut(entry);
      if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s\n%s", entry.help.c_str(), entry.key.c_str());
    }
  };
  const HandTool hand = tools_.hand;
  button("Select", hand == HandTool::Select, "hand_select");
  button("Paint", hand == HandTool::Paint, "hand_paint");
  button("Move", hand == HandTool::Move, "hand_move");
  button("Rotate", hand == HandTool::Rotate, "hand_rotate");
  button("Scale", hand == HandTool::Scale, "hand_scale");
  column = 0;
  heading("Brushes");
  for (const Brush& b : kBrushes)
    button(b.label, hand == HandTool::Brush && tools_.brush.kind == b.kind, std::string("brush_") + b.kind);
}

void Studio::drawHandSettings() {
  if (tools_.hand == HandTool::Brush || tools_.hand == HandTool::Mask) {
    BrushSettings& b = tools_.brush;
    heading(kHandToolNames[int(tools_.hand)]);
    slider("##size", b.radiusPx, 4, 600, "size %.0f px", true);
    slider("##strength", b.strength, 0, 1, "strength %.2f");
    falloffCombo(b.falloff);
    ImGui::Checkbox("Through", &b.through);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("The brush reaches all that is behind it.");
    if (tools_.hand == HandTool::Mask) return slider("##value", tools_.maskValue, 0, 1, "towards %.2f");
    ImGui::Checkbox("Only the selection", &b.onlySelected);
    ImGui::Checkbox("Keep out of the head", &b.keepOut);
    return;
  }
  heading("Select by");
  const float third = (ImGui::GetContentRegionAvail().x - 2 * ImGui::GetStyle().ItemSpacing.x) / 3;
  constexpr const char* kKinds[] = {"Vertex", "Edge", "Face", "Bundle", "Layer", "Group"};
  for (int i = 0; i < 6; ++i) {
    if (i % 3 != 0) ImGui::SameLine();
    if (toggle(kKinds[i], int(view_.settings.kind) == i, third)) view_.settings.kind = SelectKind(i);
  }
  if (tools_.hand == HandTool::Paint)
    return slider("##circle", tools_.paintRadiusPx, 4, 400, "circle %.0f px", true);
  heading("Soft selection");
  ImGui::SetNextItemWidth(-1);
  float radius = float(tools_.soft.radius);
  const float speed = float(0.05 * std::max(tools_.snap.step, 1e-6));
  if (ImGui::DragFloat("##soft", &radius, speed, 0, 1e6f, radius > 0 ? "radius %.3f" : "off"))
    tools_.soft.radius = radius;
  if (radius > 0) {
    falloffCombo(tools_.soft.falloff);
    ImGui::Checkbox("Along the mesh", &tools_.soft.surface);
  }
  heading("Axes");
  ImGui::SetNextItemWidth(-1);
  int axes = int(tools_.axes);
  if (ImGui::Combo("##axes", &axes, kAxesNames, IM_ARRAYSIZE(kAxesNames))) tools_.axes = AxesKind(axes);
  heading("Snap");
  ImGui::Checkbox("##snap", &tools_.snap.on);
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-1);
  int to = int(tools_.snap.to);
  if (ImGui::Combo("##to", &to, "to the grid\0to vertices\0to the scalp\0")) tools_.snap.to = SnapTo(to);
  if (tools_.snap.to == SnapTo::Grid) {
    ImGui::SetNextItemWidth(-1);
    ImGui::InputDouble("##step", &tools_.snap.step, 0, 0, "step %.4g");
    tools_.snap.step = std::max(tools_.snap.step, 1e-9);
  }
}

/// The middle of the selection as numbers; typing moves it.
void Studio::drawSelectionPanel() {
  const auto middle = document_ ? selectionMiddle() : std::nullopt;
  if (!middle || tools_.hand == HandTool::Brush || tools_.hand == HandTool::Mask) return;
  heading("Middle");
  for (int i = 0; i < 3; ++i) {
    double value = (*middle)[i];
    ImGui::PushID(i);
    ImGui::SetNextItemWidth(-1);
    const char* formats[] = {"X %.4g", "Y %.4g", "Z %.4g"};
    ImGui::InputDouble("##at", &value, 0, 0, formats[i]);
    if (ImGui::IsItemDeactivatedAfterEdit() && value != (*middle)[i]) {
      CommandArguments arguments{{"by", Vec3((value - (*middle)[i]) * Vec3::Unit(i))}};
      tools_.soft.addTo(arguments);
      run("translate", arguments);
    }
    ImGui::PopID();
  }
}

void Studio::drawToolPanel() {
  drawHandTools();
  drawHandSettings();
  bool symmetric = document_ && document_->editor.state().symmetric;
  if (ImGui::Checkbox("Symmetric", &symmetric)) run("symmetry", {{"on", symmetric}});
  drawSelectionPanel();
  for (const char* menu : {"Mesh", "Move"}) {
    if (!ImGui::CollapsingHeader(menu, ImGuiTreeNodeFlags_DefaultOpen)) continue;
    for (const CommandInfo& info : commandInfos()) {
      if (info.menu != menu || info.name == "displace" || info.name == "brush") continue;
      if (ImGui::Button(info.label.c_str(), {-1, 0})) begin(info.name);
      if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s\n%s", info.help.c_str(), keyOf(info.name).c_str());
    }
  }
}

}  // namespace coif::studio
