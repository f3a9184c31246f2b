// Hair colour and light: what the document says of its look.
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "coif/light/hair_color.h"
#include "coif/light/image.h"
#include "studio.h"

namespace coif::studio {
namespace {

CommandArguments lookArguments(const LookSettings& look) {
  return {{"color", Vec3(look.hairColor.cast<double>())},
          {"azimuth", look.azimuthDeg},
          {"elevation", look.elevationDeg},
          {"roughness", look.longitudinalRoughness},
          {"azimuthal_roughness", look.azimuthalRoughness}};
}

CommandArguments lightArguments(const LightSettings& light) {
  return {{"azimuth", light.azimuthDeg},
          {"elevation", light.elevationDeg},
          {"key", light.key},
          {"fill", light.fill},
          {"rim", light.rim},
          {"sky", light.sky},
          {"follow_camera", light.followCamera}};
}

/// A slider that shows `value`; true while it is dragged.
bool slide(const char* label, double& value, float least, float most, const char* format = "%.2f") {
  float shown = float(value);
  if (!ImGui::SliderFloat(label, &shown, least, most, format)) return false;
  value = double(shown);
  return true;
}

/// A ball on which the light is dragged to where it stands.
bool lightBall(LightSettings& light, float size) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImGui::InvisibleButton("ball", {size, size});
  const float radius = 0.5f * size - 3;
  const ImVec2 middle{at.x + 0.5f * size, at.y + 0.5f * size};
  bool changed = false;
  if (ImGui::IsItemActive()) {
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    const double x = std::clamp(double((mouse.x - middle.x) / radius), -1.0, 1.0),
                 y = std::clamp(double((middle.y - mouse.y) / radius), -1.0, 1.0);
    light.elevationDeg = 90 * y;
    light.azimuthDeg = 180 * x;
    changed = true;
  }
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(at, {at.x + size, at.y + size}, IM_COL32(30, 32, 36, 255), 4);
  for (int i = -1; i <= 1; ++i) {  // azimuth left to right, elevation upwards
    const float s = float(i) * 0.5f * radius;
    list.AddLine({middle.x + s, middle.y - radius}, {middle.x + s, middle.y + radius},
                 IM_COL32(255, 255, 255, 26));
    list.AddLine({middle.x - radius, middle.y + s}, {middle.x + radius, middle.y + s},
                 IM_COL32(255, 255, 255, 26));
  }
  const ImVec2 sun{middle.x + radius * float(std::remainder(light.azimuthDeg, 360) / 180),
                   middle.y - radius * float(light.elevationDeg / 90)};
  list.AddCircleFilled(sun, 6, IM_COL32(255, 220, 120, 255));
  list.AddCircle(sun, 9, IM_COL32(255, 220, 120, 110), 0, 2);
  return changed;
}

}  // namespace

void Studio::settle(const std::string& command, const CommandArguments& arguments, bool changed) {
  if (changed) pendingCommand_ = command, pendingArguments_ = arguments;
  if (pendingCommand_ != command || ImGui::IsAnyItemActive()) return;
  run(std::exchange(pendingCommand_, {}), pendingArguments_,
      [this](const std::string&) { pendingStyles_.reset(); });
}

LookSettings Studio::shownLook() const {
  return pendingLook_ && !pendingCommand_.empty() ? *pendingLook_ : document_->editor.state().look;
}

void Studio::drawLookPanel() {
  LookSettings look = shownLook();
  if (header("Hair colour")) {
    bool changed = ImGui::ColorEdit3("colour", look.hairColor.data(), ImGuiColorEditFlags_Float);
    changed |= slide("roughness", look.longitudinalRoughness, 0.02f, 1);
    changed |= slide("around", look.azimuthalRoughness, 0.02f, 1);
    constexpr HairColor kReady[] = {HairColor::Black, HairColor::Brown, HairColor::Red,
                                    HairColor::Blond, HairColor::Grey,  HairColor::Dyed};
    int column = 0;
    const float third = (ImGui::GetContentRegionAvail().x - 2 * ImGui::GetStyle().ItemSpacing.x) / 3;
    for (const HairColor ready : kReady) {
      if (column++ % 3 != 0) ImGui::SameLine();
      const Vec3 color = albedoFromAbsorption(absorptionOf(ready), look.azimuthalRoughness);
      const ImVec4 shown(float(srgbFromLinear(color.x())), float(srgbFromLinear(color.y())),
                         float(srgbFromLinear(color.z())), 1);
      ImGui::PushStyleColor(ImGuiCol_Button, shown);
      const bool dark = color.mean() < 0.2;
      ImGui::PushStyleColor(ImGuiCol_Text, dark ? ImVec4(1, 1, 1, 1) : ImVec4(0, 0, 0, 1));
      if (ImGui::Button(nameOf(ready), {third, 0})) look.hairColor = color.cast<float>(), changed = true;
      ImGui::PopStyleColor(2);
    }
    if (changed) pendingLook_ = look;
    settle("set_look", lookArguments(look), changed);
  }
  if (header("Light")) {
    LightSettings& light = look.light;
    bool changed = lightBall(light, std::min(ImGui::GetContentRegionAvail().x, 150 * window_.scale()));
    ImGui::SameLine();
    ImGui::BeginGroup();
    ImGui::Text("%.0f°\n%.0f° up", light.azimuthDeg, light.elevationDeg);
    changed |= ImGui::Checkbox("with the\ncamera", &light.followCamera);
    if (ImGui::Button("Reset")) light = {}, changed = true;
    ImGui::EndGroup();
    changed |= slide("key", light.key, 0, 4);
    changed |= slide("fill", light.fill, 0, 4);
    changed |= slide("rim", light.rim, 0, 4);
    changed |= slide("sky", light.sky, 0, 4);
    if (changed) pendingLook_ = look;
    settle("set_light", lightArguments(light), changed);
  }
}

}  // namespace coif::studio
