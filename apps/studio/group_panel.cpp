// Groups of bundles: choose, isolate, put into.
#include <imgui.h>
#include <imgui_stdlib.h>

#include "studio.h"

namespace coif::studio {

void Studio::drawGroupPanel() {
  if (!header("Groups")) return;
  const HairMesh& mesh = document_->editor.mesh();
  const auto names = mesh.groupNames();
  std::vector<std::size_t> bundles(names.size(), 0);
  for (const Bundle& bundle : mesh.bundles()) {
    if (bundle.group < bundles.size()) ++bundles[bundle.group];
  }
  std::string chosen, isolated;
  for (std::size_t g = 0; g < names.size(); ++g) {
    if (bundles[g] == 0) continue;
    ImGui::PushID(int(g));
    if (ImGui::Selectable(names[g].c_str(), false, 0,
                          {ImGui::GetContentRegionAvail().x - 70 * window_.scale(), 0}))
      chosen = names[g];
    if (ImGui::IsItemHovered())
      ImGui::SetTooltip("Selects the tips of its %zu bundles; with Shift too.", bundles[g]);
    ImGui::SameLine();
    ImGui::TextDisabled("%zu", bundles[g]);
    ImGui::SameLine();
    if (ImGui::SmallButton("only")) isolated = names[g];
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("Hides all others; Alt+H shows them again.");
    ImGui::PopID();
  }
  if (!chosen.empty()) {
    run("select_group", {{"name", chosen}, {"mode", std::string(ImGui::GetIO().KeyShift ? "add" : "set")}});
  }
  if (!isolated.empty()) {
    run("select_group", {{"name", isolated}});
    run("isolate");
  }
  ImGui::SetNextItemWidth(-90 * window_.scale());
  ImGui::InputTextWithHint("##group", "name of a group", &groupText_);
  ImGui::SameLine();
  if (ImGui::Button("Put in", {-1, 0}) && !groupText_.empty()) run("set_group", {{"name", groupText_}});
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", findCommand("set_group")->help.c_str());
}

}  // namespace coif::studio
