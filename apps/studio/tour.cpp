// The guided tour: one thing to do at a time, and on to the next when it was done.
#include <imgui.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <string>

#include "studio.h"

namespace coif::studio {
namespace {

struct Step {
  const char *title, *text;  ///< {name} stands for the key of that command
  const char* command;       ///< done when a command of this name was; empty: see isDone()
};

constexpr Step kSteps[] = {
    {"Look around",
     "Drag with the middle mouse button (Maya: Alt + left) to turn, with Shift (Alt + middle) to shift; the "
     "wheel "
     "zooms. {frame_selected} frames "
     "what is selected.",
     ""},
    {"Select",
     "Press {kind_face} for faces, then drag a box over the tips of some hair. {kind_vertex} and {kind_edge} "
     "are "
     "vertices and edges; Ctrl + drag draws a lasso, Shift adds.",
     "select"},
    {"Longer hair",
     "Press {extrude} and move the mouse, or type a number. A click or Enter does it; Escape drops it.",
     "extrude"},
    {"Move", "Press {translate} and move; X, Y or Z hold an axis, the wheel makes the move softer around.",
     "translate"},
    {"Comb",
     "Press {brush_comb} and stroke over the hair: the comb takes it along. {hand_select} puts the brush "
     "down again.",
     "brush"},
    {"Take back", "{undo} takes back as far as you like; the panel History at the right lists every step.",
     "undo"},
    {"Let it hang",
     "{drape} drapes the hair. {play} plays it in wind and with the head in motion: see the panel Motion.",
     "drape"},
    {"Keep it",
     "{save} saves, {export} exports strands for Blender, Unreal or a renderer. {palette} finds every "
     "command.",
     ""},
};
/// The text with each {name} replaced.
std::string filled(std::string text, const std::function<std::string(const std::string&)>& by) {
  for (std::size_t from = text.find('{'); from != std::string::npos; from = text.find('{', from)) {
    const std::size_t to = text.find('}', from);
    text.replace(from, to + 1 - from, by(text.substr(from + 1, to - from - 1)));
  }
  return text;
}

constexpr int kLast = int(std::size(kSteps)) - 1;

}  // namespace

void Studio::followTour(const std::string& command) {
  if (tourOpen_ && command == kSteps[tourStep_].command) tourStep_ = std::min(tourStep_ + 1, kLast);
}

void Studio::drawTour() {
  if (!tourOpen_ || !leftBehind_.empty()) return;
  if (tourStep_ == 0 && !view_.camera.eye.isApprox(tourEye_, 1e-9)) {
    // The camera as the document opened is where the first step starts from.
    const bool turned = document_ && !job_.busy() && !tourEye_.isZero(0) && ImGui::IsMouseDown(2);
    tourEye_ = view_.camera.eye;
    if (turned) tourStep_ = 1;
  }
  const float scale = window_.scale();
  const ImGuiViewport* all = ImGui::GetMainViewport();
  // Over the view, at its lower edge.
  ImGui::SetNextWindowPos(
      {view_.origin().x + 0.5f * view_.size().x, view_.origin().y + view_.size().y - 14 * scale},
      ImGuiCond_Always, {0.5f, 1});
  ImGui::SetNextWindowSize({std::min(400 * scale, all->Size.x), 0});
  bool open = true;
  if (ImGui::Begin("Two minutes with Coif", &open,
                   ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                       ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing)) {
    const Step& step = kSteps[tourStep_];
    ImGui::Text("%d of %d: %s", tourStep_ + 1, kLast + 1, step.title);
    ImGui::PushTextWrapPos(0);
    const std::string text = filled(step.text, [this](const std::string& name) {
      const std::string keys = keyOf(name);
      return keys.substr(0, keys.find(' '));
    });
    ImGui::TextDisabled("%s", text.c_str());
    ImGui::PopTextWrapPos();
    if (ImGui::Button("Back") && tourStep_ > 0) --tourStep_;
    ImGui::SameLine();
    if (ImGui::Button(tourStep_ < kLast ? "Next" : "Done"))
      tourStep_ < kLast ? void(++tourStep_) : void(open = false);
    ImGui::SameLine();
    if (ImGui::Button("Skip the tour")) open = false;
  }
  ImGui::End();
  if (open) return;
  tourOpen_ = false;
  settings_.tourSeen = true;
  (void)settings_.save();
}

}  // namespace coif::studio
