// The menu bar and the command palette: every command, from the one list.
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cctype>

#include "studio.h"

namespace coif::studio {
namespace {

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return text;
}

/// The menus of the commands, in the order in which they first appear.
std::vector<std::string> menuNames() {
  std::vector<std::string> names;
  for (const CommandInfo& info : commandInfos()) {
    if (std::ranges::find(names, info.menu) == names.end()) names.push_back(info.menu);
  }
  return names;
}

}  // namespace

void Studio::drawFileMenu() {
  if (!ImGui::BeginMenu("File")) return;
  if (ImGui::MenuItem("Open ...", "Ctrl+O")) askPath(PathUse::Open);
  if (ImGui::BeginMenu("Recent", !settings_.recent.empty())) {
    for (const std::string& path : settings_.recent) {
      if (ImGui::MenuItem(path.c_str())) openPath(path, options_.style);
    }
    ImGui::EndMenu();
  }
  const bool open = document_ != nullptr;
  if (ImGui::MenuItem("Save", "Ctrl+S", false, open)) {
    document_->path.empty() ? askPath(PathUse::SaveAs) : saveTo(document_->path);
  }
  if (ImGui::MenuItem("Save as ...", nullptr, false, open)) askPath(PathUse::SaveAs);
  if (ImGui::MenuItem("Export ...", "Ctrl+Shift+E", false, open)) askPath(PathUse::Export);
  if (ImGui::MenuItem("Screenshot ...", "F12")) askPath(PathUse::Screenshot);
  ImGui::Separator();
  if (ImGui::MenuItem("Quit")) quit_ = mayClose();
  ImGui::EndMenu();
}

void Studio::drawViewMenu() {
  ViewSettings& s = view_.settings;
  ImGui::MenuItem("Strands", nullptr, &s.showStrands);
  ImGui::MenuItem("Head", nullptr, &s.showHead);
  ImGui::MenuItem("Inner vertices", nullptr, &s.showInternal);
  if (ImGui::MenuItem("Mesh hidden", "Z", s.mesh == MeshStyle::Hidden)) s.mesh = MeshStyle::Hidden;
  if (ImGui::MenuItem("Mesh as wire", "Z", s.mesh == MeshStyle::Wire)) s.mesh = MeshStyle::Wire;
  if (ImGui::MenuItem("Mesh in x-ray", "Z", s.mesh == MeshStyle::XRay)) s.mesh = MeshStyle::XRay;
  ImGui::Separator();
  const auto look = [&](const char* label, double azimuth, double elevation) {
    if (!ImGui::MenuItem(label)) return;
    Camera& camera = view_.camera;
    camera = orbit(camera, view_.upAxis, azimuth - azimuthDegOf(camera, view_.upAxis),
                   elevation - elevationDegOf(camera, view_.upAxis));
  };
  look("Front", 0, 0), look("Left", -90, 0), look("Right", 90, 0), look("Back", 180, 0), look("Top", 0, 89);
  bool parallel = view_.camera.fovDeg < 1;
  if (ImGui::MenuItem("Parallel", nullptr, &parallel))
    view_.camera = withLens(view_.camera, parallel ? kParallelFovDeg : 30);
  if (ImGui::MenuItem("Frame all", "Home") && document_) view_.frame(document_->editor.mesh(), {});
  ImGui::Separator();
  bool maya = s.habit == MouseHabit::Maya;
  if (ImGui::MenuItem("Mouse as in Maya", nullptr, &maya)) {
    s.habit = maya ? MouseHabit::Maya : MouseHabit::Blender;
    settings_.mayaMouse = maya;
    (void)settings_.save();
  }
  if (ImGui::MenuItem("Light theme", nullptr, &settings_.lightTheme)) {
    settings_.lightTheme ? ImGui::StyleColorsLight() : ImGui::StyleColorsDark();
    (void)settings_.save();
  }
}

void Studio::drawMenus() {
  if (!ImGui::BeginMainMenuBar()) return;
  drawFileMenu();
  for (const std::string& menu : menuNames()) {
    if (!ImGui::BeginMenu(menu.c_str())) continue;
    for (const CommandInfo& info : commandInfos()) {
      if (info.menu != menu) continue;
      const std::string why = document_ ? document_->editor.refusal(info.name) : "no document is open";
      if (ImGui::MenuItem(info.label.c_str(), settings_.keyOf(info.name).c_str(), false, why.empty()))
        run(info.name);
      if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", why.empty() ? info.help.c_str() : why.c_str());
    }
    if (menu == "View") ImGui::Separator(), drawViewMenu();
    ImGui::EndMenu();
  }
  if (ImGui::BeginMenu("Help")) {
    if (ImGui::MenuItem("Find a command ...", "F3")) paletteOpen_ = true, paletteText_.clear();
    if (ImGui::MenuItem("Guided tour")) tourOpen_ = true;
    ImGui::EndMenu();
  }
  ImGui::EndMainMenuBar();
}

void Studio::drawPalette() {
  if (paletteOpen_) ImGui::OpenPopup("palette");
  const ImVec2 middle = ImGui::GetMainViewport()->GetCenter();
  ImGui::SetNextWindowPos({middle.x, middle.y * 0.4f}, ImGuiCond_Always, {0.5f, 0});
  ImGui::SetNextWindowSize({440 * window_.scale(), 0});
  if (!ImGui::BeginPopup("palette")) return;
  if (paletteOpen_) ImGui::SetKeyboardFocusHere(), paletteOpen_ = false;
  ImGui::InputText("##find", &paletteText_);
  const bool enter = window_.keys().pressed("Enter");
  const std::string wanted = lower(paletteText_);
  int shown = 0;
  for (const CommandInfo& info : commandInfos()) {
    if (lower(info.label + " " + info.name + " " + info.menu).find(wanted) == std::string::npos) continue;
    if (++shown > 12) break;
    const std::string line = info.menu + ": " + info.label + "   " + settings_.keyOf(info.name);
    if (ImGui::Selectable(line.c_str()) || (enter && shown == 1)) {
      run(info.name);
      ImGui::CloseCurrentPopup();
      break;
    }
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", info.help.c_str());
  }
  if (window_.keys().pressed("Escape")) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
}

}  // namespace coif::studio
