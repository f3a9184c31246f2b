// Selecting by id, as numbers: "12 13" of the kind that is selected, or "v 12 e 3/1/0 f 4/2".
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cctype>
#include <sstream>

#include "studio.h"

namespace coif::studio {
namespace {

/// The numbers of "3/1/0"; empty where it is none.
std::vector<double> numbersOf(const std::string& word) {
  std::vector<double> out;
  std::istringstream in(word);
  for (std::string part; std::getline(in, part, '/');) {
    if (part.empty() || part.size() > 9 ||
        !std::ranges::all_of(part, [](unsigned char c) { return std::isdigit(c); }))
      return {};
    out.push_back(std::stod(part));
  }
  return out;
}

}  // namespace

bool Studio::selectById(const std::string& text) {
  const SelectKind kind = view_.settings.kind;
  char what = kind == SelectKind::Vertex ? 'v'
              : kind == SelectKind::Edge ? 'e'
              : kind == SelectKind::Face ? 'f'
                                         : 'b';
  std::string words = text;
  std::ranges::replace(words, ',', ' ');
  std::istringstream in(words);
  CommandArguments arguments;
  const auto add = [&](const char* name, const std::vector<double>& numbers) {
    if (!arguments.contains(name)) arguments[name] = std::vector<double>{};
    auto& list = std::get<std::vector<double>>(arguments[name]);
    list.insert(list.end(), numbers.begin(), numbers.end());
  };
  for (std::string word; in >> word;) {
    if (std::string("vefb").find(word.front()) != std::string::npos) {
      what = word.front();
      word.erase(0, 1);
      if (word.empty()) continue;
    }
    const std::vector<double> numbers = numbersOf(word);
    const HairMesh& mesh = document_->editor.mesh();
    if (what == 'v' && numbers.size() == 1) {
      add("vertices", numbers);
    } else if (what == 'e' && numbers.size() == 3) {
      add("edges", numbers);
    } else if (what == 'f' && numbers.size() == 2) {
      add("faces", numbers);
    } else if (what == 'b' && numbers.size() == 1) {
      const std::uint32_t bundle = mesh.indexOf(BundleId(std::uint32_t(numbers[0])));
      for (std::uint32_t l = 0; bundle != kNone && l <= mesh.bundles()[bundle].height(); ++l)
        add("faces", {numbers[0], double(l)});
    } else {
      say("'" + word + "' is no id: v 12, e bundle/layer/side, f bundle/layer or b 7", true);
      return false;
    }
  }
  run("select", arguments);
  return true;
}

void Studio::drawSelectDialog() {
  if (idsAsked_) ImGui::OpenPopup("ids");
  const ImVec2 middle = ImGui::GetMainViewport()->GetCenter();
  ImGui::SetNextWindowPos({middle.x, middle.y * 0.4f}, ImGuiCond_Always, {0.5f, 0});
  ImGui::SetNextWindowSize({440 * window_.scale(), 0});
  if (!ImGui::BeginPopup("ids")) return;
  if (std::exchange(idsAsked_, false)) ImGui::SetKeyboardFocusHere();
  ImGui::TextUnformatted("Select by id: v 12 13, e bundle/layer/side, f bundle/layer, b 7");
  ImGui::SetNextItemWidth(-1);
  ImGui::InputText("##ids", &idsText_);
  const bool enter = window_.keys().pressed("Enter");
  if (enter && document_ && selectById(idsText_)) ImGui::CloseCurrentPopup();
  if (window_.keys().pressed("Escape")) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
}

}  // namespace coif::studio
