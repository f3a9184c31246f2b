// What to export: format, what goes into the file, as what strands are shown.
#include <imgui.h>

#include <algorithm>

#include "coif/scene/evaluate.h"
#include "studio.h"

namespace coif::studio {
namespace {

struct Format {
  const char *label, *extension, *help;
  bool mesh, cards;
};
constexpr Format kFormats[] = {
    {"USD, binary", ".usdc",
     "Blender, Houdini, Unreal, Maya: curves with widths, ids, root UVs; head and hair mesh beside them.",
     true, false},
    {"USD, text", ".usda", "The same, to be read by people.", true, false},
    {"glTF, one file", ".glb", "Viewers and engines: strands as cards or tubes, and as lines.", true, true},
    {"glTF, text", ".gltf", "The same in text and a file of numbers.", true, true},
    {"cyHair", ".hair", "Renderers and research: points and widths alone.", false, false},
};

}  // namespace

void Studio::drawExportDialog() {
  if (!exportOpen_) return;
  constexpr const char* kTitle = "Export strands";
  if (!ImGui::IsPopupOpen(kTitle)) ImGui::OpenPopup(kTitle);
  const float scale = window_.scale();
  ImGui::SetNextWindowPos(ImGui::GetMainViewport()->GetCenter(), ImGuiCond_Appearing, {0.5f, 0.5f});
  ImGui::SetNextWindowSize({420 * scale, 0}, ImGuiCond_Appearing);
  if (!ImGui::BeginPopupModal(kTitle, nullptr, ImGuiWindowFlags_NoResize)) return;
  for (int i = 0; i < int(std::size(kFormats)); ++i) {
    if (ImGui::RadioButton((std::string(kFormats[i].label) + "  " + kFormats[i].extension).c_str(),
                           exportFormat_ == i))
      exportFormat_ = i;
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", kFormats[i].help);
  }
  constexpr int kLast = int(std::size(kFormats)) - 1;
  if (window_.keys().pressed("Down")) exportFormat_ = std::min(exportFormat_ + 1, kLast);
  if (window_.keys().pressed("Up")) exportFormat_ = std::max(exportFormat_ - 1, 0);
  const Format& format = kFormats[exportFormat_];
  ImGui::Separator();
  ImGui::PushTextWrapPos(0);
  ImGui::TextDisabled("%s", format.help);
  ImGui::PopTextWrapPos();
  if (format.cards) {
    int mesh = int(exportMesh_);
    constexpr const char* kMeshes[] = {"lines alone", "cards", "tubes"};
    if (ImGui::Combo("strands as", &mesh, kMeshes, IM_ARRAYSIZE(kMeshes))) exportMesh_ = StrandMesh(mesh);
  }
  if (document_)
    ImGui::TextDisabled("%zu strands; the panel Strands sets how many.",
                        document_->editor.state().strands.count);
  constexpr std::uint32_t kUnrealPoints = 255;
  if (document_ && format.extension[1] == 'u' && document_->editor.state().strands.points > kUnrealPoints)
    ImGui::TextWrapped("Unreal takes %u points a strand at most; these have up to %u.", kUnrealPoints,
                       document_->editor.state().strands.points);
  const bool goesOn = ImGui::Button("Choose a file ...") || window_.keys().pressed("Enter");
  ImGui::SameLine();
  const bool drops = ImGui::Button("Cancel") || window_.keys().pressed("Escape");
  if (goesOn || drops) {
    exportOpen_ = false;
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
  if (!goesOn) return;
  askPath(PathUse::Export);
  pathText_ = std::filesystem::path(pathText_).replace_extension(format.extension).string();
}

}  // namespace coif::studio
