// The key map: every command and action with its key, changed by pressing another.
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cctype>

#include "studio.h"

namespace coif::studio {
namespace {

bool holds(const std::string& text, const std::string& wanted) {
  return std::ranges::search(text, wanted, [](unsigned char a, unsigned char b) {
           return std::tolower(a) == std::tolower(b);
         }).begin() != text.end();
}

/// Whether two lists of combinations have one in common.
bool clash(const std::string& a, const std::string& b) {
  for (std::size_t from = 0, to; from < a.size(); from = to + 1) {
    to = std::min(a.find(' ', from), a.size());
    if ((' ' + b + ' ').find(' ' + a.substr(from, to - from) + ' ') != std::string::npos) return true;
  }
  return false;
}

}  // namespace

void Studio::takeNewKey() {
  const std::string key = window_.keys().lastName();
  if (key.empty()) return;
  const std::string name = std::exchange(keyAskedFor_, {});
  if (key == "Escape") return;
  if (key == "Backspace") {
    settings_.keys[name] = "";
  } else {
    settings_.keys[name] = key;
  }
  if (const Status saved = settings_.save(); !saved.ok()) say(saved.error().text(), true);
}

void Studio::drawKeyMap() {
  if (!keyMapOpen_) return;
  const float scale = window_.scale();
  const ImVec2 middle = ImGui::GetMainViewport()->GetCenter();
  ImGui::SetNextWindowPos(middle, ImGuiCond_Appearing, {0.5f, 0.5f});
  ImGui::SetNextWindowSize({520 * scale, 420 * scale}, ImGuiCond_Appearing);
  if (!ImGui::Begin("Keys", &keyMapOpen_, ImGuiWindowFlags_NoCollapse)) return ImGui::End();
  ImGui::SetNextItemWidth(-110 * scale);
  ImGui::InputTextWithHint("##find", "find a command or a key", &keyMapText_);
  ImGui::SameLine();
  if (ImGui::Button("All as shipped", {-1, 0})) {
    settings_.keys.clear();
    (void)settings_.save();
  }
  const std::vector<MenuEntry> all = entries();
  if (ImGui::BeginTable("keys", 3, ImGuiTableFlags_ScrollY | ImGuiTableFlags_RowBg)) {
    ImGui::TableSetupColumn("command", ImGuiTableColumnFlags_WidthStretch);
    ImGui::TableSetupColumn("key", ImGuiTableColumnFlags_WidthFixed, 150 * scale);
    ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthFixed, 60 * scale);
    for (const MenuEntry& entry : all) {
      if (!holds(entry.menu + ": " + entry.label + " " + entry.key, keyMapText_)) continue;
      ImGui::PushID(entry.name.c_str());
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      ImGui::AlignTextToFramePadding();
      ImGui::Text("%s: %s", entry.menu.c_str(), entry.label.c_str());
      if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", entry.help.c_str());
      ImGui::TableNextColumn();
      const bool asked = keyAskedFor_ == entry.name;
      const auto other = std::ranges::find_if(
          all, [&](const MenuEntry& e) { return e.name != entry.name && clash(entry.key, e.key); });
      const bool clashes = other != all.end();
      if (clashes) ImGui::PushStyleColor(ImGuiCol_Text, {1, 0.45f, 0.35f, 1});
      const std::string label = asked ? "press a key ..." : entry.key.empty() ? "–" : entry.key;
      if (ImGui::Button((label + "###key").c_str(), {-1, 0})) keyAskedFor_ = entry.name;
      if (clashes) ImGui::PopStyleColor();
      if (ImGui::IsItemHovered()) {
        ImGui::SetTooltip("%s", clashes
                                    ? ("also of " + other->label).c_str()
                                    : "Click, then press the new key; Backspace: none, Escape: as it was.");
      }
      ImGui::TableNextColumn();
      if (settings_.keys.contains(entry.name) && ImGui::SmallButton("reset")) {
        settings_.keys.erase(entry.name);
        (void)settings_.save();
      }
      ImGui::PopID();
    }
    ImGui::EndTable();
  }
  ImGui::End();
}

}  // namespace coif::studio
