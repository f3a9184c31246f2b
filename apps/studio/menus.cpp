// The menu bar and the command palette: every command, from the one list.
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cctype>
#include <iterator>
#include <sstream>

#include "studio.h"

namespace coif::studio {
namespace {

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return text;
}

/// What stands before the first slash, and after it.
std::pair<std::string, std::string> split(const std::string& menu) {
  const std::size_t slash = menu.find('/');
  return {menu.substr(0, slash), slash == std::string::npos ? "" : menu.substr(slash + 1)};
}

}  // namespace

void Studio::drawEntry(const MenuEntry& entry) {
  const std::string why = refusalOf(entry);
  const bool ticked = entry.action != nullptr && entry.action->ticked && entry.action->ticked();
  const std::string key = entry.key.substr(0, entry.key.find(' '));
  if (ImGui::MenuItem(entry.label.c_str(), key.c_str(), ticked, why.empty())) carryOut(entry);
  if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled))
    ImGui::SetTooltip("%s", why.empty() ? entry.help.c_str() : why.c_str());
}

void Studio::drawRecentMenu() {
  if (!ImGui::BeginMenu("Recent", !settings_.recent.empty())) return;
  const std::vector<std::string> paths = settings_.recent;  // opening one changes the list
  for (const std::string& path : paths) {
    if (ImGui::MenuItem(path.c_str())) leaveDocument([this, path] { openPath(path, options_.style); });
  }
  ImGui::EndMenu();
}

void Studio::drawMenus() {
  if (!ImGui::BeginMainMenuBar()) return;
  const std::vector<MenuEntry> all = entries();
  std::vector<std::string> menus;
  for (const MenuEntry& entry : all) {
    const std::string menu = split(entry.menu).first;
    if (std::ranges::find(menus, menu) == menus.end()) menus.push_back(menu);
  }
  for (const std::string& menu : menus) {
    if (!ImGui::BeginMenu(menu.c_str())) continue;
    std::vector<std::string> inner;
    for (const MenuEntry& entry : all) {
      const auto [name, below] = split(entry.menu);
      if (name != menu) continue;
      if (below.empty()) {
        drawEntry(entry);
      } else if (std::ranges::find(inner, below) == inner.end()) {
        inner.push_back(below);
      }
    }
    for (const std::string& below : inner) {
      if (!ImGui::BeginMenu(below.c_str())) continue;
      for (const MenuEntry& entry : all) {
        if (entry.menu == menu + "/" + below) drawEntry(entry);
      }
      ImGui::EndMenu();
    }
    if (menu == "File") drawRecentMenu();
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
  std::vector<MenuEntry> found = entries();
  std::erase_if(found, [&](const MenuEntry& entry) {
    const std::string text = lower(entry.label + " " + entry.name + " " + entry.menu);
    std::istringstream words(wanted);  // each of them, in any order
    return std::any_of(std::istream_iterator<std::string>(words), {},
                       [&](const std::string& word) { return text.find(word) == std::string::npos; });
  });
  // What is meant to the letter comes first, and what only mentions it after what begins with it.
  const auto rank = [&](const MenuEntry& entry) {
    const std::string label = lower(entry.label);
    return entry.name == wanted || label == wanted ? 0 : label.starts_with(wanted) ? 1 : 2;
  };
  std::ranges::stable_sort(found, {}, rank);
  for (const MenuEntry& entry : found) {
    if (++shown > 12) break;
    const std::string line = entry.menu + ": " + entry.label + "   " + entry.key;
    if (ImGui::Selectable(line.c_str()) || (enter && shown == 1)) {
      carryOut(entry);
      ImGui::CloseCurrentPopup();
      break;
    }
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", entry.help.c_str());
  }
  if (window_.keys().pressed("Escape")) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
}

}  // namespace coif::studio
