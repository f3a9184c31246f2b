// The panels beside the view: tools, strands, look, the last command's numbers, history, stages, Python.
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>

#include "studio.h"

namespace coif::studio {
namespace {

constexpr float kLeastPanel = 180, kLeastView = 170;  // at a scale of 1

}  // namespace

void Studio::drawPanels() {
  const ImGuiViewport* all = ImGui::GetMainViewport();
  const float scale = window_.scale(), line = ImGui::GetFrameHeightWithSpacing();
  const float left = settings_.leftPanel * scale, right = settings_.rightPanel * scale;
  const ImVec2 at = all->WorkPos, size = all->WorkSize;
  // In a small window the view comes first.
  const bool roomy = size.x > left + right + (kLeastView - 10) * scale;
  constexpr ImGuiWindowFlags kFixed = ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                                      ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoTitleBar |
                                      ImGuiWindowFlags_NoBringToFrontOnFocus;
  float height = std::max(size.y - line, 1.0f);
  height -= drawConsole(at, {size.x, height});
  if (roomy) {
    ImGui::SetNextWindowPos(at);
    ImGui::SetNextWindowSize({left, height});
    ImGui::Begin("tools", nullptr, kFixed);
    drawToolPanel();
    ImGui::End();
    dragEdge("tools edge", {at.x + left, at.y}, height, settings_.leftPanel, 1, size.x - right);
    ImGui::SetNextWindowPos({at.x + size.x - right, at.y});
    ImGui::SetNextWindowSize({right, height});
    ImGui::Begin("settings", nullptr, kFixed);
    if (document_) {
      drawAdjustPanel();
      drawStrandPanel();
      drawStylePanel();
      drawLookPanel();
      drawMotionPanel();
      drawGroupPanel();
      drawHistoryPanel();
      drawStagePanel();
      drawPythonPanel();
    } else {
      ImGui::TextWrapped("Drop a head or a .coif document here, or press Ctrl+O.");
    }
    ImGui::End();
    dragEdge("settings edge", {at.x + size.x - right, at.y}, height, settings_.rightPanel, -1, size.x - left);
  }
  ImGui::SetNextWindowPos({at.x, at.y + size.y - line});
  ImGui::SetNextWindowSize({size.x, line});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {8 * scale, 2 * scale});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, {1, 1});
  ImGui::Begin("status", nullptr, kFixed | ImGuiWindowFlags_NoScrollbar);
  drawStatusLine();
  ImGui::End();
  ImGui::PopStyleVar(2);
  view_.scale = scale;
  view_.place({at.x + (roomy ? left : 0), at.y}, {size.x - (roomy ? left + right : 0), height});
}

/// A panel's edge towards the view, which changes its width; `sign`: to which side it grows.
void Studio::dragEdge(const char* name, const ImVec2& at, float height, float& width, float sign,
                      float room) {
  const float scale = window_.scale(), thick = 6 * scale;
  ImGui::SetNextWindowPos({at.x - 0.5f * thick, at.y});
  ImGui::SetNextWindowSize({thick, height});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, {1, 1});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 0);
  ImGui::Begin(name, nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing |
                   ImGuiWindowFlags_NoNav);
  ImGui::InvisibleButton("edge", {thick, height});
  const bool held = ImGui::IsItemActive();
  if (held || ImGui::IsItemHovered()) {
    ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    ImGui::GetForegroundDrawList()->AddLine({at.x, at.y}, {at.x, at.y + height},
                                            ImGui::GetColorU32(ImGuiCol_SeparatorHovered), 2 * scale);
  }
  // By where the mouse is, not by how far it went: at its limits the edge waits for the mouse.
  if (held) {
    const float wanted = width + sign * (ImGui::GetIO().MousePos.x - at.x) / scale;
    width = std::clamp(wanted, kLeastPanel, std::max(room / scale - kLeastView, kLeastPanel));
  }
  if (ImGui::IsItemDeactivated()) (void)settings_.save();
  ImGui::End();
  ImGui::PopStyleVar(3);
}

bool Studio::header(const char* label, bool opens) {
  if (opens) settings_.open[label] = true;
  ImGui::SetNextItemOpen(settings_.open[label], opens ? ImGuiCond_Always : ImGuiCond_Once);
  const bool open = ImGui::CollapsingHeader(label);
  if (ImGui::IsItemToggledOpen()) {
    settings_.open[label] = open;
    (void)settings_.save();
  }
  return open;
}

bool Studio::drawArgument(const CommandArgument& argument, CommandArguments& values) const {
  CommandValue value = values.contains(argument.name) ? values[argument.name] : argument.standard;
  bool changed = false;
  const char* label = argument.name.c_str();
  switch (argument.kind) {
    case ArgumentKind::Flag:
      changed = ImGui::Checkbox(label, &std::get<bool>(value));
      break;
    case ArgumentKind::Number:
      changed = ImGui::InputDouble(label, &std::get<double>(value), 0, 0, "%.5g",
                                   ImGuiInputTextFlags_EnterReturnsTrue);
      break;
    case ArgumentKind::Integer:
      changed = ImGui::InputDouble(label, &std::get<double>(value), 0, 0, "%.0f",
                                   ImGuiInputTextFlags_EnterReturnsTrue);
      break;
    case ArgumentKind::Text:
      changed = ImGui::InputText(label, &std::get<std::string>(value), ImGuiInputTextFlags_EnterReturnsTrue);
      break;
    case ArgumentKind::Vector:
      changed = ImGui::InputScalarN(label, ImGuiDataType_Double, std::get<Vec3>(value).data(), 3, nullptr,
                                    nullptr, "%.4g", ImGuiInputTextFlags_EnterReturnsTrue);
      break;
    case ArgumentKind::Choice:
      if (ImGui::BeginCombo(label, std::get<std::string>(value).c_str())) {
        for (const std::string& choice : argument.choices) {
          if (ImGui::Selectable(choice.c_str(), choice == std::get<std::string>(value)))
            value = choice, changed = true;
        }
        ImGui::EndCombo();
      }
      break;
    case ArgumentKind::Numbers:
      return false;  // lists come from the mouse or from scripts
  }
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", argument.help.c_str());
  if (changed) values[argument.name] = value;
  return changed;
}

void Studio::drawAdjustPanel() {
  const CommandInfo* info = findCommand(lastCommand_);
  if (info == nullptr || info->arguments.empty() || info->name == "select") return;
  const bool hasPanel =
      info->menu == "Style" || (info->name.starts_with("set_") && info->name != "set_group");
  if (hasPanel) return;
  if (!ImGui::CollapsingHeader((info->label + "###adjust").c_str(), ImGuiTreeNodeFlags_DefaultOpen)) return;
  CommandArguments values = lastArguments_;
  bool changed = false;
  for (const CommandArgument& argument : info->arguments) changed |= drawArgument(argument, values);
  if (!changed) return;
  const std::string command = lastCommand_;
  run("undo");
  run(command, values);
}

void Studio::drawStrandPanel() {
  if (!header("Strands")) return;
  const StrandSettings& s = document_->editor.state().strands;
  CommandArguments values{{"count", double(s.count)}, {"points", double(s.points)},
                          {"tolerance", s.tolerance}, {"seed", double(s.seed)},
                          {"width", s.width},         {"tip_width", s.tipWidth}};
  bool changed = false;
  for (const CommandArgument& argument : findCommand("set_strands")->arguments)
    changed |= drawArgument(argument, values);
  if (changed) run("set_strands", values);
}

void Studio::drawHistoryPanel() {
  if (!header("History")) return;
  const std::vector<std::string> labels = document_->editor.stepLabels();
  const std::size_t done = document_->editor.undoCount();
  ImGui::BeginChild("steps", {0, 140 * window_.scale()});
  std::size_t wanted = done;
  if (ImGui::Selectable("(opened)", done == 0)) wanted = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    ImGui::PushID(int(i));
    if (ImGui::Selectable(labels[i].c_str(), i + 1 == done)) wanted = i + 1;
    ImGui::PopID();
  }
  ImGui::EndChild();
  while (document_->editor.undoCount() > wanted) run("undo");
  while (document_->editor.undoCount() < wanted) run("redo");
}

void Studio::drawStagePanel() {
  if (!header("Stages")) return;
  for (const StageReport& stage : stages_) {
    ImGui::Text("%s: %s, %.1f ms", stage.name.c_str(), name(stage.state), 1e3 * stage.seconds);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", stage.reason.c_str());
  }
}

void Studio::drawPythonPanel() {
  if (!header("Python")) return;
  std::string log = document_->editor.pythonLog();
  if (ImGui::Button("Copy")) ImGui::SetClipboardText(log.c_str());
  ImGui::InputTextMultiline("##log", &log, {-1, 140 * window_.scale()}, ImGuiInputTextFlags_ReadOnly);
}

void Studio::drawStatusLine() {
  if (job_.busy()) return drawProgress();
  if (messageIsProblem_) {
    ImGui::TextColored({1, 0.45f, 0.35f, 1}, "%s", message_.c_str());
  } else {
    ImGui::TextUnformatted(tool_ ? tool_->status().c_str() : message_.c_str());
  }
  if (!document_) return;
  const Editor& editor = document_->editor;
  ImGui::SameLine(0, 24);
  ImGui::TextDisabled("%zu bundles  %zu vertices  %zu selected  |  %zu strands drawn in %.0f ms%s",
                      editor.mesh().bundles().size(), editor.mesh().vertices().size(),
                      editor.state().selection.size(), strandsDrawn_, 1e3 * pictureSeconds_,
                      pictures_->busy() ? " ..." : "");
}

}  // namespace coif::studio
