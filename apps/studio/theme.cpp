#include "theme.h"

#include <imgui.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

namespace coif::studio {
namespace {

constexpr float kFontPx = 13;

const char* fontFile() {
  static constexpr const char* kKnown[] = {
      "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
      "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
      "/usr/share/fonts/TTF/DejaVuSans.ttf",
      "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf",
      "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
      "/usr/share/fonts/truetype/liberation2/LiberationSans-Regular.ttf",
  };
  std::error_code ignored;
  if (const char* own = std::getenv("COIF_FONT"); own != nullptr && std::filesystem::exists(own, ignored))
    return own;
  for (const char* path : kKnown) {
    if (std::filesystem::exists(path, ignored)) return path;
  }
  return nullptr;
}

/// Greys from the back to the front, and one warm accent: what is on, grabbed or selected.
struct Palette {
  ImVec4 back, panel, field, fieldOver, fieldHeld, line, text, faint, accent, accentSoft;
};

ImVec4 rgb(int hex, float alpha = 1) {
  return {float(hex >> 16 & 255) / 255, float(hex >> 8 & 255) / 255, float(hex & 255) / 255, alpha};
}

Palette paletteOf(bool light) {
  if (light) {
    return {rgb(0xd9d7d4), rgb(0xe9e7e4), rgb(0xfbfaf9), rgb(0xffffff), rgb(0xf3e2cc),
            rgb(0xbdb9b4), rgb(0x26241f), rgb(0x77736c), rgb(0xc0701c), rgb(0xc0701c, 0.30f)};
  }
  return {rgb(0x17181a), rgb(0x222326), rgb(0x303237), rgb(0x3b3e44), rgb(0x484b52),
          rgb(0x0f1011), rgb(0xe3e1dd), rgb(0x8f9096), rgb(0xe69a3c), rgb(0xe69a3c, 0.32f)};
}

void applyColors(ImGuiStyle& style, bool light) {
  light ? ImGui::StyleColorsLight(&style) : ImGui::StyleColorsDark(&style);
  const Palette p = paletteOf(light);
  ImVec4* c = style.Colors;
  c[ImGuiCol_Text] = p.text, c[ImGuiCol_TextDisabled] = p.faint;
  c[ImGuiCol_WindowBg] = p.panel, c[ImGuiCol_PopupBg] = p.panel, c[ImGuiCol_MenuBarBg] = p.back;
  c[ImGuiCol_ChildBg] = {0, 0, 0, light ? 0.03f : 0.12f};
  c[ImGuiCol_Border] = p.line, c[ImGuiCol_Separator] = p.line;
  c[ImGuiCol_FrameBg] = c[ImGuiCol_Button] = p.field;
  c[ImGuiCol_FrameBgHovered] = c[ImGuiCol_ButtonHovered] = p.fieldOver;
  c[ImGuiCol_FrameBgActive] = c[ImGuiCol_ButtonActive] = p.fieldHeld;
  c[ImGuiCol_TitleBg] = c[ImGuiCol_TitleBgActive] = c[ImGuiCol_TitleBgCollapsed] = p.back;
  c[ImGuiCol_Header] = p.field, c[ImGuiCol_HeaderHovered] = p.fieldOver,
  c[ImGuiCol_HeaderActive] = p.fieldHeld;
  c[ImGuiCol_CheckMark] = c[ImGuiCol_SliderGrab] = c[ImGuiCol_SliderGrabActive] = p.accent;
  c[ImGuiCol_ScrollbarBg] = {0, 0, 0, 0};
  c[ImGuiCol_ScrollbarGrab] = p.field, c[ImGuiCol_ScrollbarGrabHovered] = p.fieldOver;
  c[ImGuiCol_ScrollbarGrabActive] = p.fieldHeld;
  c[ImGuiCol_SeparatorHovered] = c[ImGuiCol_SeparatorActive] = p.accent;
  c[ImGuiCol_ResizeGrip] = {0, 0, 0, 0},
  c[ImGuiCol_ResizeGripHovered] = c[ImGuiCol_ResizeGripActive] = p.accent;
  c[ImGuiCol_Tab] = p.back, c[ImGuiCol_TabHovered] = p.fieldOver, c[ImGuiCol_TabActive] = p.field;
  c[ImGuiCol_PlotHistogram] = c[ImGuiCol_PlotLines] = p.accent;
  c[ImGuiCol_TextSelectedBg] = c[ImGuiCol_NavHighlight] = c[ImGuiCol_DragDropTarget] = p.accentSoft;
}

}  // namespace

void applyTheme(bool light, float scale) {
  ImGuiStyle style;
  applyColors(style, light);
  style.WindowRounding = 0, style.ChildRounding = 3, style.FrameRounding = 3, style.PopupRounding = 4;
  style.GrabRounding = 3, style.ScrollbarRounding = 6, style.TabRounding = 3;
  style.WindowPadding = {10, 8}, style.FramePadding = {5, 3}, style.ItemSpacing = {7, 5};
  style.ScrollbarSize = 12, style.GrabMinSize = 9, style.IndentSpacing = 16;
  style.WindowBorderSize = 1, style.FrameBorderSize = light ? 1.0f : 0.0f;
  style.ScaleAllSizes(scale);
  ImGui::GetStyle() = style;

  ImFontAtlas& fonts = *ImGui::GetIO().Fonts;
  fonts.Clear();
  ImFontConfig config;
  config.SizePixels = std::round(kFontPx * scale);
  static constexpr ImWchar kGlyphs[] = {0x20, 0x17f, 0x2010, 0x2044, 0x2190, 0x21ff, 0x2500, 0x25ff, 0};
  const char* file = fontFile();
  if (file == nullptr || fonts.AddFontFromFileTTF(file, config.SizePixels, &config, kGlyphs) == nullptr) {
    config.SizePixels = std::round(13 * scale);
    fonts.AddFontDefault(&config);
  }
  ImGui::GetIO().FontGlobalScale = 1;
}

}  // namespace coif::studio
