// The console's window: what was printed, a line to type in, run and stop.
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>

#include "studio.h"

namespace coif::studio {
namespace {

/// Up and down bring back what was typed before.
struct Recall {
  const std::vector<std::string>& lines;
  int& at;  // below 0: the line being typed

  static int turn(ImGuiInputTextCallbackData* data) {
    auto& self = *static_cast<Recall*>(data->UserData);
    const int last = int(self.lines.size()) - 1;
    if (last < 0) return 0;
    if (data->EventKey == ImGuiKey_UpArrow) self.at = self.at < 0 ? last : std::max(self.at - 1, 0);
    if (data->EventKey == ImGuiKey_DownArrow) self.at = self.at < 0 || self.at == last ? -1 : self.at + 1;
    data->DeleteChars(0, data->BufTextLen);
    if (self.at >= 0) data->InsertChars(0, self.lines[std::size_t(self.at)].c_str());
    return 0;
  }
};

}  // namespace

float Studio::drawConsole(const ImVec2& at, const ImVec2& size) {
  if (!settings_.console) return 0;
  const float scale = window_.scale();
  const float height =
      std::clamp(settings_.consoleHeight * scale, 60 * scale, std::max(0.6f * size.y, 60 * scale));
  if (size.y < 160 * scale) return 0;  // in a small window the view comes first
  ImGui::SetNextWindowPos({at.x, at.y + size.y - height});
  ImGui::SetNextWindowSize({size.x, height});
  ImGui::Begin("console", nullptr,
               ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse |
                   ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoBringToFrontOnFocus);
  ImGui::InvisibleButton("edge", {-1, 4 * scale});  // its upper edge is dragged
  if (ImGui::IsItemHovered() || ImGui::IsItemActive()) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeNS);
  if (ImGui::IsItemActive()) settings_.consoleHeight -= ImGui::GetIO().MouseDelta.y / scale;
  if (ImGui::IsItemDeactivated()) (void)settings_.save();

  const float line = ImGui::GetFrameHeightWithSpacing();
  ImGui::BeginChild("printed", {0, -line});
  ImGui::PushTextWrapPos(0);
  const std::string& text = console_.text();
  if (text.empty()) {
    ImGui::TextDisabled("Python. `editor` is the open document: editor.select_all(); editor.smooth(steps=3)");
  }
  ImGui::TextUnformatted(text.data(), text.data() + text.size());
  ImGui::PopTextWrapPos();
  if (console_.takeGrown()) ImGui::SetScrollHereY(1);
  ImGui::EndChild();

  ImGui::TextUnformatted(console_.wantsMore() ? "..." : ">>>");
  ImGui::SameLine();
  const float buttons = 190 * scale;
  ImGui::SetNextItemWidth(std::max(ImGui::GetContentRegionAvail().x - buttons, 40.0f));
  Recall recall{typedBefore_, typedAt_};
  // A field of its own for each line: one that is being typed in holds on to its text.
  ImGui::PushID(int(typedBefore_.size()));
  if (typedAt_ == kNextLine) {
    ImGui::SetKeyboardFocusHere();
    typedAt_ = kTyping;
  }
  ImGui::InputText("##line", &typed_, ImGuiInputTextFlags_CallbackHistory, Recall::turn, &recall);
  ImGui::PopID();
  // By the keys of this frame: the field itself has let go of the text when it says that Enter was pressed.
  const bool typing = ImGui::IsItemActive() || ImGui::IsItemDeactivated();
  if (typing && window_.keys().pressed("Enter")) {
    typedBefore_.push_back(typed_);
    typedAt_ = kNextLine;
    console_.execute(std::exchange(typed_, {}));
  }
  ImGui::SameLine();
  if (ImGui::Button("Run ...")) askPath(PathUse::RunScript);
  ImGui::SameLine();
  if (console_.busy()) {
    if (ImGui::Button("Stop")) console_.stop();
  } else if (ImGui::Button("Clear")) {
    console_.clear();
  }
  ImGui::End();
  return height;
}

}  // namespace coif::studio
